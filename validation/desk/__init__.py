"""The workbench without its face: everything a window does, as data and as functions over a `Desk`.

A desk is a folder: what was asked, a working copy of the model with its ladder, and what was computed. Nothing in it is a page or
a picture; a face (`validation.app`) asks, shows and owns no physics. What takes longer than a blink runs in a worker of its own.

| module | nouns | verbs |
| --- | --- | --- |
| `desk` | `Desk`, `Asked` | `begun`, `opened`, `view`, `keep_view` |
| `examples` | `Example`, `Series` | `examples`, `series` |
| `handed` | `Handed`, `Received` | `received` |
| `faults` | `Fault` | `faults` |
| `jobs` | `Job`, `Worker` | `start`, `job`; `Worker.cancel` |
| `comparing` | `Compared` | `compared`, `comparison` |
| `entries` | `Curve`, `Cell`, `Entry` | `curves`, `entry_of`, `worst` |
| `scene` | `Scene` | `scene` |
| `shapes` | `Shape` | `nearest`, `shape` |
| `diagnosing` | - | `diagnosed`, `diagnosis` |
| `explaining` | `Explained`, `Shown` | `explained` |
| `climbing` | - | `added`, `ladder`, `undone`, `gone_to` |
| `table` | `Table` | `table` |
| `whatif` | `WhatIf`, `Trace` | `what_if` |
| `sliders` | `Effect`, `Slider` | `reaching`, `sliders` |
| `saving` | - | `model_text`, `ladder_text`, `save` |
"""
