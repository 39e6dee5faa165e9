"""The window: a PyQt5 program that drives and shows both robots of one name.

Data flows one way. `link` exchanges messages with robots on its own threads and assembles the `World`. `bridge` passes
the reports of the link to Qt's thread. `state` decides, without Qt, what the window shows (a `View`) and which `Action`s
follow from an `Intent` of the user. Widgets show views and emit intents, and decide nothing.
"""
