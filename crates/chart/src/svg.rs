//! The elements of SVG that charts need.

use std::fmt::Write as _;

/// Elements as text.
#[derive(Debug, Default)]
pub(crate) struct Svg {
    text: String,
}

/// Which side of a text its place is at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

impl Anchor {
    fn word(self) -> &'static str {
        match self {
            Self::Start => "start",
            Self::Middle => "middle",
            Self::End => "end",
        }
    }
}

/// The unit of [`Svg::paths`] [px].
const TENTH: f64 = 0.1;

impl Svg {
    fn add(&mut self, element: std::fmt::Arguments<'_>) {
        // Writing to a string cannot fail.
        let _ = self.text.write_fmt(element);
        self.text.push('\n');
    }

    pub(crate) fn line(&mut self, class: &str, from: (f64, f64), to: (f64, f64)) {
        self.add(format_args!(
            r#"<line class="{class}" x1="{:.1}" y1="{:.1}" x2="{:.1}" y2="{:.1}"/>"#,
            from.0, from.1, to.0, to.1
        ));
    }

    /// A line through points; `dashes`: lengths of strokes and gaps, empty for none.
    pub(crate) fn polyline(&mut self, class: &str, points: &[(f64, f64)], dashes: &str) {
        let places: Vec<String> = points.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
        let dashes = if dashes.is_empty() { String::new() } else { format!(r#" stroke-dasharray="{dashes}""#) };
        self.add(format_args!(r#"<polyline class="{class}" points="{}"{dashes}/>"#, places.join(" ")));
    }

    /// Many lines as one element, in as few bytes as can be: whole tenths of a pixel, each point from the one before.
    pub(crate) fn paths(&mut self, class: &str, lines: &[Vec<(f64, f64)>]) {
        let whole = |&(x, y): &(f64, f64)| ((x / TENTH).round() as i64, (y / TENTH).round() as i64);
        let mut path = String::new();
        for line in lines {
            let Some(mut last) = line.first().map(whole) else { continue };
            // Writing to a string cannot fail.
            let _ = write!(path, "M{} {}", last.0, last.1);
            let mut before = 'l';
            for next in line[1..].iter().map(whole) {
                for step in [next.0 - last.0, next.1 - last.1] {
                    // A sign parts numbers as well as a space does.
                    let gap = if before == 'l' {
                        "l"
                    } else if step < 0 {
                        ""
                    } else {
                        " "
                    };
                    let _ = write!(path, "{gap}{step}");
                    before = ' ';
                }
                last = next;
            }
        }
        self.add(format_args!(r#"<path class="{class}" transform="scale({TENTH})" d="{path}"/>"#));
    }

    /// A rectangle from its upper left corner; `title` is shown where a pointer rests on it.
    pub(crate) fn rectangle(&mut self, class: &str, corner: (f64, f64), size: (f64, f64), title: &str) {
        let title = if title.is_empty() { String::new() } else { format!("<title>{}</title>", escaped(title)) };
        self.add(format_args!(
            r#"<rect class="{class}" x="{:.1}" y="{:.1}" width="{:.1}" height="{:.1}">{title}</rect>"#,
            corner.0, corner.1, size.0, size.1
        ));
    }

    /// A disc; `title` is shown where a pointer rests on it.
    pub(crate) fn disc(&mut self, class: &str, (x, y): (f64, f64), radius: f64, title: &str) {
        let title = if title.is_empty() { String::new() } else { format!("<title>{}</title>", escaped(title)) };
        self.add(format_args!(r#"<circle class="{class}" cx="{x:.1}" cy="{y:.1}" r="{radius}">{title}</circle>"#));
    }

    /// A ring around a place.
    pub(crate) fn ring(&mut self, class: &str, (x, y): (f64, f64), radius: f64) {
        self.add(format_args!(
            r#"<circle class="{class}" cx="{x:.1}" cy="{y:.1}" r="{radius}" fill="none" stroke-width="2.2"/>"#
        ));
    }

    pub(crate) fn text(&mut self, class: &str, (x, y): (f64, f64), size: f64, anchor: Anchor, text: &str) {
        let (anchor, text) = (anchor.word(), escaped(text));
        self.add(format_args!(
            r#"<text class="{class}" x="{x:.1}" y="{y:.1}" font-size="{size}" text-anchor="{anchor}">{text}</text>"#
        ));
    }

    pub(crate) fn bold(&mut self, (x, y): (f64, f64), size: f64, text: &str) {
        let text = escaped(text);
        self.add(format_args!(r#"<text x="{x:.1}" y="{y:.1}" font-size="{size}" font-weight="600">{text}</text>"#));
    }

    /// Text that runs upwards.
    pub(crate) fn upright(&mut self, class: &str, (x, y): (f64, f64), size: f64, text: &str) {
        let text = escaped(text);
        self.add(format_args!(
            r#"<text class="{class}" x="{x:.1}" y="{y:.1}" font-size="{size}" text-anchor="middle" transform="rotate(-90 {x:.1} {y:.1})">{text}</text>"#
        ));
    }

    /// The whole file.
    pub(crate) fn finish(self, size: (f64, f64), title: &str, sheet: &str) -> String {
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {w:.0} {h:.0}\" width=\"{w:.0}\" height=\"{h:.0}\" role=\"img\">\n\
             <title>{}</title>\n<style>{sheet}</style>\n{}</svg>\n",
            escaped(title),
            self.text,
            w = size.0,
            h = size.1
        )
    }
}

/// Width of a text about [px].
pub(crate) fn width(text: &str, size: f64) -> f64 {
    0.56 * size * text.chars().count() as f64
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
