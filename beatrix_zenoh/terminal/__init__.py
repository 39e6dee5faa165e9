"""What every verb needs: options, the robots it applies to, and how it is run and reports errors."""
