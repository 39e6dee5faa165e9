"""The verbs of recordings: record, note, view, compare, replay, export."""
