"""The file of an evaluation: one JSON line per episode, appended as soon as the episode ends.

A file holds episodes of one split under one set of conditions, which a header file beside it
holds. An evaluation that was killed resumes: an incomplete last line is dropped, and finished
sessions are not rolled out again.
"""

import json
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

from kitchen_prefs.evaluation.tiers import AnyEpisode, tier_of
from kitchen_prefs.metrics import category_accuracy
from kitchen_prefs.utils.files import write_json


@dataclass(frozen=True)
class EvaluationConditions:
    """What all episodes of a file have in common.

    Attributes:
        policy: The policy's type.
        fingerprint: A hash of its weights and of the settings that change its behaviour.
        track: The track: "standard", "privileged" or "language".
        prompt_of: The preference that the prompt demonstrates: the "same" or an "other" one.
        prompts: How many demonstrations prompt an episode.
        expert_states: Whether the decisions were taken in the expert's states.
        salt: The session seed; 0 is the published one.
        data_version: The version of the sessions.
        package_version: The version of this package.
        given_prompt: The hash of a prompt that was given; None for the benchmark's prompts.
    """

    policy: str
    fingerprint: str
    track: str
    prompt_of: str
    prompts: int
    expert_states: bool
    salt: int
    data_version: int
    package_version: str
    given_prompt: str | None = None


class EpisodeFile:
    """The episodes of one split under one set of conditions, on disk.

    Args:
        path: A .jsonl file; it and its folder are created if missing.
        conditions: The conditions of the episodes that are appended.

    Attributes:
        episodes: The episodes in the file, in the order in which they ended.

    Raises:
        ValueError: If the file holds episodes under other or unknown conditions, or cannot be read.
    """

    def __init__(self, path: Path, conditions: EvaluationConditions) -> None:
        self.path = path
        self.conditions = conditions
        path.parent.mkdir(parents=True, exist_ok=True)
        _check_conditions(path, conditions)
        _drop_incomplete_line(path)
        self.episodes = read_episodes(path)

    def append(self, episode: AnyEpisode) -> None:
        """Write an episode, with its metrics and failure modes."""
        with self.path.open("a") as file:
            file.write(json.dumps(asdict(episode) | self._metrics(episode)) + "\n")
        self.episodes.append(episode)

    def _metrics(self, episode: Any) -> dict[str, dict[str, Any]]:
        """The metrics and failure modes of an episode.

        In the expert's states the expert loads the racks, so only the accuracy of the policy's
        choices is measured.
        """
        if self.conditions.expert_states:
            return {"metrics": {"Category accuracy": category_accuracy(episode)}}
        tier = tier_of(episode.split)
        return {
            "metrics": {name: metric(episode) for name, metric in tier.metrics.items()},
            "failure_modes": tier.failure_modes(episode),
        }


def read_episodes(path: Path) -> list[Any]:
    """Read the episodes of a file, each of its split's tier.

    Raises:
        ValueError: If a line is not an episode.
    """
    lines = path.read_text().splitlines()
    return [_parse(line, f"Line {n} of {path}") for n, line in enumerate(lines, start=1)]


def _check_conditions(path: Path, conditions: EvaluationConditions) -> None:
    header = path.with_suffix(".header.json")
    way_out = "give another --out, or delete that folder."
    if not header.exists():
        if path.exists() and path.stat().st_size:
            raise ValueError(
                f"{path} holds episodes of an unknown policy, as {header.name} is not "
                f"there; {way_out}"
            )
        write_json(header, asdict(conditions))
        return
    there = read_header(header, way_out)
    differing = [name for name, value in asdict(conditions).items() if there.get(name) != value]
    if differing:
        raise ValueError(
            f"{path} holds episodes of another policy or under other conditions: another "
            f"{' and '.join(differing)}; {way_out}"
        )


def read_header(header: Path, way_out: str) -> dict:
    """Read the conditions of a file of episodes.

    Args:
        header: The file beside it.
        way_out: The end of the error message: what the user can do.

    Raises:
        ValueError: If it is no header.
    """
    try:
        content = json.loads(header.read_text())
    except ValueError:
        content = None
    if not isinstance(content, dict) or "fingerprint" not in content:
        raise ValueError(f"{header} is damaged; {way_out}")
    return content


def _drop_incomplete_line(path: Path) -> None:
    path.touch()
    content = path.read_bytes()
    if not content.endswith(b"\n"):
        with path.open("r+b") as file:
            file.truncate(content.rfind(b"\n") + 1)


def _parse(line: str, where: str) -> AnyEpisode:
    try:
        content = json.loads(line)
        episode = tier_of(content["split"]).episode
        return episode(**{field.name: _tuples(content[field.name]) for field in fields(episode)})
    except (KeyError, TypeError, ValueError) as error:
        raise ValueError(f"{where} is not an episode; delete the file to start anew.") from error


def _tuples(value: Any) -> Any:
    """Turn lists, as JSON has them, into the tuples of an episode."""
    return tuple(map(_tuples, value)) if isinstance(value, list) else value
