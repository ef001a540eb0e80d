// Whether the overlay is marked at a frequency [Hz].
(at) => document.querySelector("#overlay").layout.shapes?.some((one) => Math.abs(one.x0 - at) < 1e-3 * at) ?? false
