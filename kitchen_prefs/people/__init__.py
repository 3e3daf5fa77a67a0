"""The second tier: people with rules on material, colour, soil and size, and the dishes for it.

attributes    what a dish is beside its category, and in which classes people divide dishes
users         a user: hand wash, exceptions, base zones, overflow, order, style
user_sampling the prior of the grammar, from which users are drawn
words         a user in words
expert        loads a kitchen as a user does
splits        the ten splits
sessions      session i of a split: its user, its dishes, its prompts
posterior     the exact reader of the grammar: what a demonstration says of its user
certificates  whether a prompt says enough
"""
