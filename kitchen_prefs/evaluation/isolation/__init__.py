"""A policy in a process of its own, which receives observations and returns actions.

isolated_policy  starts the process and talks to it; to `roll_out` it is a policy like another
messages         the format of what passes through the pipe
policy_settings  where its checkpoint lies
policy_process   the program of the process: loads the policy and acts
sandbox          no network, no other processes, nothing else of the disk to read or to write to
system_calls     what the kernel refuses to the process: others beside it, and sockets
"""
