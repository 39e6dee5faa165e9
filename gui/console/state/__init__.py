"""All decisions of the window, without Qt, clock, thread or network.

`State.view(world)` returns what to show; `State.handle(intent, world)` returns what to do. Read `world` and `intents`
first (the input), then `views` and `actions` (the output), then `state`.
"""
