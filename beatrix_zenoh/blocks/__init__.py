"""Programs of blocks: data that Blockly saves, carried out block by block, and the same programs as Python."""
