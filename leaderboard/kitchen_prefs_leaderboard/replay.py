"""Replays a submission's actions in the simulator."""

from collections.abc import Sequence

from kitchen_prefs import instances
from kitchen_prefs.envs.simulator import Simulator
from kitchen_prefs.evaluation.tiers import AnyEpisode, tier_of
from kitchen_prefs.simulation.counter_layout import POSE_DECIMALS
from kitchen_prefs_leaderboard.submission_format import ACTIONS, FARTHEST, Line
from kitchen_prefs_leaderboard.submission_reading import SubmissionFiles


def replay_split(submission: SubmissionFiles, split: str) -> list[AnyEpisode]:
    """Replay a submission's episodes of a split.

    Raises:
        ValueError: If the file does not follow the format, or if an episode does not begin or end
            in the states that it names.
    """
    file = submission.folder / ACTIONS[split]
    return [
        replay(split, line, f"{file}, line {number}")
        for number, line in enumerate(submission.lines(split), start=1)
    ]


def replay(split: str, line: Line, where: str) -> AnyEpisode:
    """Replay one episode.

    Args:
        split: The split of the session.
        line: The episode, as the submission has it.
        where: Names the line in errors.

    Raises:
        ValueError: If the first or the last state is not the one that the line names, or if the
            actions end too early or too late.
    """
    simulator = tier_of(split).make_simulator(split, line.session)
    if simulator.digest() != line.first:
        raise ValueError(
            f"{where}: session {line.session} of {split} begins in another state than this."
        )
    for number, action in enumerate(line.actions, start=1):
        if simulator.terminated or simulator.truncated:
            raise ValueError(f"{where}: the episode ends before action {number}.")
        simulator.act(action)
    if not (simulator.terminated or simulator.truncated):
        raise ValueError(f"{where}: the episode continues after the last action.")
    if simulator.digest() != line.last:
        raise ValueError(f"{where}: the actions do not lead to the last state that it names.")
    return simulator.episode()


def write_line(episode: AnyEpisode) -> Line:
    """An episode as a line of a submission.

    Actions are rounded. One that would then choose another instance, or that lies too far away,
    becomes the pose that it chose.

    Args:
        episode: An episode of a published session.
    """
    simulator = tier_of(episode.split).make_simulator(episode.split, episode.session)
    first = simulator.digest()
    actions: list[Sequence[float]] = []
    for action, instance in zip(episode.actions, episode.decisions, strict=True):
        actions.append(_written(action, instance, simulator))
        simulator.decide(instance, actions[-1])
    return Line(
        session=episode.session,
        first=first,
        actions=[(x, y, z, w, i, j, k) for x, y, z, w, i, j, k in actions],
        last=simulator.digest(),
    )


def _written(action: Sequence[float], instance: int, simulator: Simulator) -> Sequence[float]:
    """An action as it is written, which chooses the instance that the action chose."""
    rounded = [round(value, POSE_DECIMALS) for value in action]
    near = all(abs(value) <= FARTHEST for value in rounded)
    if near and simulator.choose(rounded)[0] == instance:
        return rounded
    row = simulator.observation.row_of(instance)
    return [float(value) for value in simulator.observation.rows[row, instances.POSE]]


def to_jsonl(lines: Sequence[Line]) -> bytes:
    """The content of a file of lines, before compression."""
    return b"".join(line.model_dump_json().encode() + b"\n" for line in lines)
