"""An episode for rerun's viewer: cameras, clusters and decisions; nothing where it is missing."""

from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from kitchen_prefs_robot.perception.cloud import Frame
from kitchen_prefs_robot.perception.detection import Detection
from kitchen_prefs_robot.perception.pictures import cluster_colour

NAME = "kitchen_prefs_drawers"


class RerunLog:
    """Writes an .rrd file.

    Args:
        path: The file, which is written as the episode goes.
    """

    def __init__(self, path: Path) -> None:
        self._recording: Any = None
        if find_spec("rerun") is not None:
            import rerun

            self._rerun = rerun
            self._recording = rerun.RecordingStream(NAME)
            self._recording.save(path)

    def look(self, decision: int, frame: Frame, detections: Sequence[Detection]) -> None:
        """The front camera's picture and the clusters, before a decision, which count from 1."""
        if self._recording is None:
            return
        self._recording.set_time("decision", sequence=decision)
        self._recording.log("cameras/front", self._rerun.Image(frame.colour))
        self._recording.log("clusters", self._rerun.Clear(recursive=True))  # those that are gone
        for number, dish in enumerate(detections):
            points = self._rerun.Points3D(
                dish.cloud.points, colors=cluster_colour(number), radii=0.003
            )
            self._recording.log(f"clusters/{number}", points)

    def step(self, decision: int, text: str) -> None:
        """What was chosen, and how it ended."""
        if self._recording is not None:
            self._recording.set_time("decision", sequence=decision)
            self._recording.log("decisions", self._rerun.TextLog(text))

    def close(self) -> None:
        """Write what is left."""
        if self._recording is not None:
            self._recording.flush()
