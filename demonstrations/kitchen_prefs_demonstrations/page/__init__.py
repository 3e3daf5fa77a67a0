"""A policy in a static page: TTP in JavaScript, and what it needs to observe the kitchen."""
