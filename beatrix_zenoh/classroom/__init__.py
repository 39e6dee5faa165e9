"""A class: its accounts, their access rules and files, and its router."""
