"""Both robots of one name: previews, plans, motions with a lead, state and lag."""
