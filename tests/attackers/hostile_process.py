"""A process that misbehaves in place of a policy's: `HOSTILE` in the settings says how."""

import json
import os
import sys
import time

import numpy as np

from kitchen_prefs.evaluation.isolation import policy_process


def serve(settings, requests, replies):
    behaviour = settings["policy_type"]
    describe = {"type": "hostile", "parameters": 0, "fingerprint": "0" * 64, "track": "standard"}
    if behaviour == "silent":
        time.sleep(3600)
    if behaviour == "lies":
        describe = {"type": 3}
    if behaviour == "floods":
        replies.write((2**31).to_bytes(4, "big") + b"x" * 10**6)
        replies.flush()
    policy_process.send(replies, **describe)
    requests.read(1)
    while behaviour == "dawdles":  # and answers each time just before it would be ended
        time.sleep(0.1)
        policy_process.send(replies, {"actions": np.zeros((1, 7))})
    if behaviour == "sleeps":
        time.sleep(3600)
    if behaviour == "exits":
        os._exit(0)
    if behaviour == "hoards":
        hoard = []
        while True:
            hoard.append(np.empty(10**7))
    if behaviour == "prints":  # until the disk is full, if nothing stops it
        while True:
            os.write(2, b"x" * 2**20)
    actions = np.zeros((2, 7)) if behaviour == "huge" else np.zeros((1, 3))
    policy_process.send(replies, {"actions": actions})


policy_process.serve = serve
if __name__ == "__main__":
    json.loads(sys.argv[1])
    policy_process.main()
