"""What one episode leaves behind: a line and a picture for each decision, a video, an outcome.

OUT/decisions.jsonl   for each decision what was seen, what was chosen, how it ended
OUT/looks/03.png      what the front camera saw before decision 3, and the clusters found in it
OUT/episode.mp4       the whole robot, captioned
OUT/episode.rrd       the same for rerun, if it is installed
OUT/outcome.json      what came of it

Decisions count from 1; the last picture was taken after the last of them. While the hand holds a
dish no clusters are looked for.
"""

import json
from dataclasses import asdict
from pathlib import Path
from typing import Self

import numpy as np
from PIL import Image

from kitchen_prefs.utils.files import write_json
from kitchen_prefs_robot.execution.episode import RobotEpisode
from kitchen_prefs_robot.execution.outcomes import EpisodeOutcome
from kitchen_prefs_robot.execution.rerun_log import RerunLog
from kitchen_prefs_robot.execution.step import Step
from kitchen_prefs_robot.execution.video import Video
from kitchen_prefs_robot.execution.watching import Watcher
from kitchen_prefs_robot.perception.cameras import laboratory_poses
from kitchen_prefs_robot.perception.pictures import beside_clusters
from kitchen_prefs_robot.scene import Pictures, World
from kitchen_prefs_robot.scene.views import VISITOR
from kitchen_prefs_robot.task.decisions import Decision, Pick, Place, Toggle
from kitchen_prefs_robot.task.state import DrawersState

CAMERA = "front"
SIZE = (480, 360)  # pixels of the video
EVERY = 5  # commands of the arm, 50 a simulated second, from one frame of the video to the next
STILL = 12  # frames that the last one stands


def in_words(state: DrawersState, decision: Decision) -> str:
    """A decision as a short sentence."""
    if isinstance(decision, Toggle):
        verb = "close" if state.opened == decision.drawer else "open"
        return f"{verb} the {decision.drawer} drawer"
    if isinstance(decision, Pick):
        return f"pick the {state.dishes[decision.dish].category}"
    assert isinstance(decision, Place)
    return f"drop the {state.in_hand} into the {decision.drawer} drawer"


class DecisionLog(Watcher):
    """Watches an episode and writes what it saw; a context manager that closes its files.

    Args:
        folder: An empty folder, which is filled.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        (folder / "looks").mkdir()
        self._rerun = RerunLog(folder / "episode.rrd")
        self._pictures: Pictures | None = None
        self._video: Video | None = None
        self._picture = np.zeros((*SIZE[::-1], 3), np.uint8)
        self._caption = ("", "")
        self._commands = 0
        self._touching: list[str] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self._pictures is not None:
            self._pictures.__exit__()
        if self._video is not None:
            self._video.close()
        self._rerun.close()

    def look(self, episode: RobotEpisode) -> None:
        """Note the last decision, and what is seen before the next one."""
        done = len(episode.steps)
        if done:
            self._write_step(done, episode.steps[-1])
        self._touching = [touching.sentence for touching in episode.look.touching]
        if episode.blind or not episode.look.frames:
            return
        frame = episode.look.frames[CAMERA]
        poses, found = laboratory_poses(), episode.look.detections
        picture = beside_clusters(frame, poses[CAMERA], found)
        Image.fromarray(picture).save(self._folder / "looks" / f"{done + 1:02}.png")
        self._rerun.look(done + 1, frame, found)

    def decide(self, episode: RobotEpisode, decision: Decision) -> None:
        """Caption the frames that follow with the decision that is about to be executed."""
        number = f"{len(episode.steps) + 1} of at most {episode.limit}"
        self._caption = (
            episode.preference.in_words,
            f"Decision {number}: {in_words(episode.state, decision)}",
        )

    def frame(self, world: World) -> None:
        """Take a frame of the video; every `EVERY`-th call does."""
        self._commands += 1
        if self._commands % EVERY:
            return
        if self._pictures is None or self._video is None:
            self._pictures = Pictures(world, *SIZE)
            self._video = Video(self._folder / "episode.mp4", *SIZE)
        self._picture = self._pictures.colour(VISITOR)
        self._video.add(self._picture, *self._caption)

    def finish(self, outcome: EpisodeOutcome) -> None:
        """Write the outcome, and let the video end with it."""
        share = f"{round(outcome.right * outcome.dishes)} of {outcome.dishes} dishes right"
        if self._video is not None:
            for _ in range(STILL):
                self._video.add(self._picture, self._caption[0], share)
        write_json(self._folder / "outcome.json", asdict(outcome))

    def _write_step(self, number: int, step: Step) -> None:
        line = {
            "decision": number,
            "seen": [asdict(dish) for dish in step.state.dishes],
            "touching": self._touching,
            "opened": step.state.opened,
            "in_hand": step.state.in_hand,
            "chosen": in_words(step.state, step.decision),
            "refusal": step.refusal,
            "result": step.result,
        }
        with (self._folder / "decisions.jsonl").open("a") as file:
            file.write(f"{json.dumps(line)}\n")
        self._rerun.step(number, f"{line['chosen']}: {step.refusal or step.result}")
