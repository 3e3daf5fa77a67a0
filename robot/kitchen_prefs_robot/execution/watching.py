"""Who watches an episode is told what happens."""

from kitchen_prefs_robot.execution.episode import RobotEpisode
from kitchen_prefs_robot.scene import World
from kitchen_prefs_robot.task.decisions import Decision


class Watcher:
    """Watches an episode; this one keeps nothing of it."""

    def look(self, episode: RobotEpisode) -> None:
        """The robot has looked: before each decision, and at the end."""

    def decide(self, episode: RobotEpisode, decision: Decision) -> None:
        """A decision is about to be executed."""

    def frame(self, world: World) -> None:
        """The arm moves: 50 times a simulated second."""


NOBODY = Watcher()
