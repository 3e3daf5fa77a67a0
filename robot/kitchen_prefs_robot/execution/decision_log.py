"""What one episode leaves behind: a line and a picture for each decision, a video, an outcome.

OUT/decisions.jsonl   for each decision what was seen, what was chosen, how it ended
OUT/looks/03.png      what the front camera saw before decision 3, and the clusters found in it
OUT/episode.mp4       the whole robot, captioned
OUT/episode.rrd       the same for rerun, if it is installed
OUT/outcome.json      what came of it
"""

import json
from dataclasses import asdict
from fractions import Fraction
from pathlib import Path
from textwrap import fill

import av
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from kitchen_prefs.utils.files import write_json
from kitchen_prefs_robot.execution.episode import RobotEpisode, Step
from kitchen_prefs_robot.execution.outcomes import EpisodeOutcome
from kitchen_prefs_robot.execution.rerun_log import RerunLog
from kitchen_prefs_robot.execution.watching import Watcher
from kitchen_prefs_robot.perception.cameras import laboratory_poses
from kitchen_prefs_robot.perception.pictures import beside_clusters
from kitchen_prefs_robot.scene import Pictures, World
from kitchen_prefs_robot.task.decisions import Decision, Pick, Place, Toggle
from kitchen_prefs_robot.task.state import DrawersState

CAMERA, VISITOR = "front", "visitor"
SIZE = (480, 360)  # pixels of the video
EVERY = 5  # commands of the arm, 50 a simulated second, from one frame of the video to the next
FPS = 20  # twice as fast as it was
STILL = 12  # frames that the last one stands
BAR = 58  # pixels of the caption's bar: three lines
CHARACTERS = 76  # of 11 pixels that fit beside one another
INK, PAPER = (250, 248, 243), (38, 46, 51)


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
    """Watches an episode and writes what it saw.

    Args:
        folder: An empty folder, which is filled.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        (folder / "looks").mkdir()
        self._frames: list[Image.Image] = []
        self._rerun = RerunLog(folder / "episode.rrd")
        self._pictures: Pictures | None = None
        self._caption = ("", "")
        self._commands = 0
        self._touching: list[str] = []

    def look(self, episode: RobotEpisode) -> None:
        """Note the last decision, and what is seen before the next one."""
        if episode.steps:
            self._write_step(len(episode.steps) - 1, episode.steps[-1])
        self._touching = [touching.sentence for touching in episode.look.touching]
        if not episode.look.frames:
            return
        frame = episode.look.frames[CAMERA]
        poses, found = laboratory_poses(), episode.look.detections
        picture = beside_clusters(frame, poses[CAMERA], found)
        Image.fromarray(picture).save(self._folder / "looks" / f"{len(episode.steps):02}.png")
        self._rerun.look(len(episode.steps), frame, found)

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
        if self._pictures is None:
            self._pictures = Pictures(world, *SIZE)
        self._frames.append(_captioned(self._pictures.colour(VISITOR), self._caption))

    def finish(self, outcome: EpisodeOutcome) -> None:
        """Write the video and the outcome, and release OpenGL."""
        if self._pictures is not None:
            self._pictures.__exit__()
        if self._frames:
            last = np.asarray(self._frames[-1])[:-BAR]
            share = f"{round(outcome.right * outcome.dishes)} of {outcome.dishes} dishes right"
            self._frames += [_captioned(last, (self._caption[0], share))] * STILL
            write_video(self._frames, self._folder / "episode.mp4")
        self._rerun.close()
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


def write_video(frames: list[Image.Image], path: Path) -> None:
    """Write pictures of one size as an MP4 that browsers show."""
    with av.open(str(path), "w") as container:
        stream = container.add_stream("libx264", rate=Fraction(FPS))
        stream.width, stream.height = frames[0].size
        stream.pix_fmt = "yuv420p"
        for frame in frames:
            container.mux(stream.encode(av.VideoFrame.from_image(frame)))
        container.mux(stream.encode())


def _captioned(picture: np.ndarray, caption: tuple[str, str]) -> Image.Image:
    """A picture, (H, W, 3) uint8, above a bar: the preference in words, and the decision."""
    height, width, _ = picture.shape
    page = Image.new("RGB", (width, height + BAR), PAPER)
    page.paste(Image.fromarray(picture))
    draw = ImageDraw.Draw(page)
    preference, decision = caption
    small, large = ImageFont.load_default(11), ImageFont.load_default(14)
    draw.multiline_text((8, height + 4), fill(preference, CHARACTERS), INK, small, spacing=1)
    draw.text((8, height + 36), decision, INK, large)
    return page
