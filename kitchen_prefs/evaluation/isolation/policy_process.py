"""The program of a policy's process: `python -P -m ...policy_process SETTINGS`.

It loads the policy, says what it is, and answers observations with actions until the pipe closes.
No environment, session, seed, expert or label is ever in this process: what a policy finds here,
however far it looks, is what it was sent.
"""

import json
import os
import resource
import sys
from typing import BinaryIO

from kitchen_prefs.evaluation.isolation.messages import PipeClosedError, receive, send

MOST_FILE = 64 * 1024 * 1024  # bytes of a file that it writes, its log included
MOST_OBSERVATION = 256 * 1024 * 1024  # bytes; a batch of 16 with one prompt each has 1.6 million


def main() -> None:
    """Serve one policy.

    SETTINGS is a JSON object of `load_policy`'s arguments and the memory that the process may take.
    """
    settings = json.loads(sys.argv[1])
    memory = settings.pop("memory")
    resource.setrlimit(resource.RLIMIT_DATA, (memory, memory))
    resource.setrlimit(resource.RLIMIT_FSIZE, (MOST_FILE, MOST_FILE))
    requests, replies = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    os.dup2(2, 1)  # what the policy prints goes into the log
    serve(settings, requests, replies)


def serve(settings: dict, requests: BinaryIO, replies: BinaryIO) -> None:
    """Load a policy and answer requests until there are no more.

    Args:
        settings: The arguments of `load_policy`.
        requests: Messages with a seed, which begin a batch of episodes, or with observations.
        replies: What the policy is, then the actions for each batch of observations, (B, 7).
    """
    import torch

    from kitchen_prefs.evaluation.policy_loading import load_policy

    try:
        loaded = load_policy(**settings)
    except ValueError as error:  # a sentence for whoever named the policy
        send(replies, refused=str(error))
        return
    send(
        replies,
        type=loaded.type,
        plugin=loaded.plugin,
        parameters=loaded.parameters,
        fingerprint=loaded.fingerprint,
        track=loaded.track,
    )
    while True:
        try:
            head, observations = receive(requests, MOST_OBSERVATION)
        except PipeClosedError:
            return
        if "seed" in head:
            torch.manual_seed(head["seed"])
            loaded.reset()
            continue
        batch = range(len(head["tasks"]))
        one_by_one = [{name: all_[i] for name, all_ in observations.items()} for i in batch]
        send(replies, {"actions": loaded.act(one_by_one, head["tasks"])})


if __name__ == "__main__":
    main()
