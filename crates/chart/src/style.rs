//! Colours, for light and for dark pages.

/// How many colours lines and bars have; more begin anew.
pub(crate) const COLOURS: usize = 8;

/// Colours on light pages: those of Okabe and Ito, which colour-blind readers can tell apart, yellow darkened.
const LIGHT: [&str; COLOURS] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#b8860b", "#7a4fb5", "#7f7f7f"];
/// The same on dark pages, lighter.
const DARK: [&str; COLOURS] = ["#4aa8e0", "#ff8a3c", "#2fcf9f", "#e79bc4", "#8fd3ff", "#e0b93c", "#b18cf0", "#a8a8a8"];

/// Colours of a map, from low to high, on pages of both kinds.
const STEPS: [&str; MAP_STEPS] = ["#2c7bb6", "#6fb3d2", "#abd9e9", "#f2f0b6", "#fdc270", "#f07c4a", "#c2222b"];
/// How many they are.
pub(crate) const MAP_STEPS: usize = 7;

/// The style sheet of every figure. Classes: `k` frames, `m` muted text, `b` text on bars, `g` grid lines,
/// `p` fronts, `l` lines, `t` thin ones, `s0` .. strokes, `f0` .. fills, `q0` .. cells of maps, `n` one without a
/// value, `c` text in them.
pub(crate) fn sheet() -> String {
    let colours = |palette: &[&str; COLOURS]| -> String {
        let rule = |(k, colour): (usize, &&str)| format!(".s{k}{{stroke:{colour}}}.f{k}{{fill:{colour}}}");
        palette.iter().enumerate().map(rule).collect()
    };
    let steps: String = STEPS.iter().enumerate().map(|(k, colour)| format!(".q{k}{{fill:{colour}}}")).collect();
    format!(
        "text{{font-family:system-ui,-apple-system,'Segoe UI',Helvetica,Arial,sans-serif;fill:#1f2328}}\
         .m{{fill:#59636e}}.b{{fill:#ffffff}}.g{{stroke:#e4e7eb;stroke-width:1}}\
         .k{{stroke:#59636e;stroke-width:1;fill:none}}\
         .p{{stroke:#8c959f;stroke-width:5;fill:none;opacity:.35;stroke-linejoin:round}}\
         .l{{fill:none;stroke-width:1.6;stroke-linejoin:round}}.t{{fill:none;stroke-width:9;stroke-linejoin:round}}.n{{fill:#8c959f}}.c{{fill:#14181d}}{}{steps}\
         @media (prefers-color-scheme:dark){{text{{fill:#e6edf3}}.m{{fill:#9198a1}}.b{{fill:#0d1117}}.g{{stroke:#2a3038}}\
         .k{{stroke:#9198a1}}.p{{stroke:#9198a1}}.c{{fill:#14181d}}{}}}",
        colours(&LIGHT),
        colours(&DARK)
    )
}
