"""The Hugging Face hub, with its client's errors as one sentence each.

The client, huggingface_hub, finds the token itself: that of `hf auth login`, or HF_TOKEN.
"""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from json import JSONDecodeError
from pathlib import Path

from httpx import HTTPError
from huggingface_hub import CommitInfo, CommitOperationAdd, HfApi
from huggingface_hub.constants import ENDPOINT
from huggingface_hub.errors import (
    HfHubHTTPError,
    HFValidationError,
    LocalEntryNotFoundError,
    OfflineModeIsEnabled,
)
from huggingface_hub.utils import validate_repo_id

REFUSALS = {
    401: (
        "The hub does not know you, or knows no {repo_id}; log in with `hf auth login`, or put "
        "a token of yours into HF_TOKEN."
    ),
    403: "Your token may not write to {repo_id}; use one that may, or give another --repo-id.",
    404: "The hub has no {repo_id}, or you may not see it; give another --repo-id.",
}


def check_repo_id(repo_id: str) -> None:
    """Make sure that a repository can have this name.

    Raises:
        ValueError: If it is not like OWNER/NAME.
    """
    try:
        validate_repo_id(repo_id)
        named = "/" in repo_id
    except HFValidationError:
        named = False
    if not named:
        raise ValueError(f"No repository can be named {repo_id!r}; give --repo-id=OWNER/NAME.")


def commit(
    repo_id: str,
    repo_type: str,
    files: Mapping[str, Path | bytes],
    message: str,
    description: str = "",
    create_pr: bool = False,
) -> CommitInfo:
    """Upload files to a repository in one commit, so that all of them arrive or none.

    Args:
        repo_id: The repository, OWNER/NAME.
        repo_type: "dataset" or "space".
        files: The files, by their path in the repository.
        message: The commit message.
        description: The commit description.
        create_pr: Whether it goes into a new pull request.
    """
    return HfApi().create_commit(
        repo_id,
        [CommitOperationAdd(path, content) for path, content in files.items()],
        commit_message=message,
        commit_description=description,
        repo_type=repo_type,
        create_pr=create_pr,
    )


@contextmanager
def hub_errors(repo_id: str) -> Iterator[None]:
    """Turn the errors of the hub's client into an OSError of one sentence."""
    try:
        yield
    except LocalEntryNotFoundError as error:  # nothing in the cache, and no answer
        raise OSError(
            f"No hub answers for {repo_id}; unset HF_HUB_OFFLINE, and look after the network and "
            "the environment variable HF_ENDPOINT."
        ) from error
    except HfHubHTTPError as error:
        raise OSError(_refusal(error, repo_id)) from error
    except OfflineModeIsEnabled as error:
        raise OSError("HF_HUB_OFFLINE=1 keeps everything from the hub; unset it.") from error
    except (HTTPError, JSONDecodeError) as error:  # no answer, or one that is none of a hub
        raise OSError(
            f"No hub answers at {ENDPOINT}; look after the network and the environment variable "
            "HF_ENDPOINT, and push again."
        ) from error
    except (OSError, RuntimeError) as error:  # the client's, for a large file
        raise OSError(f"An upload to {repo_id} broke off; push again.") from error


def _refusal(error: HfHubHTTPError, repo_id: str) -> str:
    status = error.response.status_code
    if status in REFUSALS:
        return REFUSALS[status].format(repo_id=repo_id)
    said = (error.server_message or "no reason given").splitlines()[0]
    return f"The hub refuses what goes to {repo_id} ({status}: {said}); try again later."
