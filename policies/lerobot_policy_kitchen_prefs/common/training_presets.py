"""Which optimiser a configuration names: the paper's, or the one that trained a checkpoint."""

from dataclasses import fields

from lerobot.configs import PreTrainedConfig


def check_one_optimizer(config: PreTrainedConfig) -> None:
    """Refuse settings of the paper's optimiser beside another optimiser, which ignores them.

    Args:
        config: A configuration with the fields `optimizer` and `scheduler`, and `optimizer_...`
            for the paper's optimiser.

    Raises:
        ValueError: If such a field is changed while `optimizer` is given, or if `scheduler` is
            given without it.
    """
    optimizer, scheduler = getattr(config, "optimizer", None), getattr(config, "scheduler", None)
    if optimizer is None:
        if scheduler is not None:
            raise ValueError("A scheduler belongs to an optimizer; give policy.optimizer too.")
        return
    for field in fields(config):
        prefix, _, name = field.name.partition("optimizer_")
        if not prefix and name and getattr(config, field.name) != field.default:
            raise ValueError(
                f"The policy trains with {optimizer.type}, so {field.name} has no effect; set "
                f"policy.optimizer.{name} instead."
            )
