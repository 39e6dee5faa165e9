"""The window: a PyQt5 program that drives and shows both robots of one name.

Data flows one way. `link` talks to robots on threads of its own and returns the `World`; `bridge` moves its reports to
Qt's thread; `state` decides, without Qt, what the window shows (a `View`) and which `Action`s follow from an `Intent`
of the user; widgets show views and emit intents, and decide nothing.
"""
