"""Figures to look into with a pointer: the door to plotly. Data go in, a figure comes out; nothing is computed here.

overlay.overlay                 any entry of the 6 x 6: measured, predicted, further predictions, magnitude above phase
maps.channel_map, pair_map      where a model fails, in sigmas; a click tells frequency and row
evidence.evidence               ranked causes with sizes and intervals; a click tells the id
errors.four_errors, before_and_after
ladder.falling_errors           from rung to rung; a click tells the number of the rung
condition.condition             of Eqs. 9 to 11
inertia.identified_inertia      ten values with 95 % intervals beside their reference
embedded                        the library and figures for a page that stands alone

Every function takes `dark`. What differs by it is the template alone (`theme.template`).
"""
