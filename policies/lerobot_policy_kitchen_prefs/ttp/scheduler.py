"""The paper's learning-rate schedule, which LeRobot does not have."""

from dataclasses import dataclass

from lerobot.optim import LRSchedulerConfig
from torch.optim import Optimizer
from torch.optim.lr_scheduler import LambdaLR


@LRSchedulerConfig.register_subclass("exponential_decay")
@dataclass
class ExponentialDecaySchedulerConfig(LRSchedulerConfig):
    """The learning rate times `decay` after every `every` updates (paper, appendix "Training").

    Attributes:
        num_warmup_steps: A field that LeRobot asks of every schedule; the paper has no warm-up.
        decay: The factor.
        every: How many updates lie between two decays.
    """

    num_warmup_steps: int | None = None
    decay: float = 0.9995
    every: int = 10

    def build(self, optimizer: Optimizer, num_training_steps: int) -> LambdaLR:
        """Make the schedule; it does not depend on the number of training steps."""
        return LambdaLR(optimizer, lambda step: self.decay ** (step // self.every))
