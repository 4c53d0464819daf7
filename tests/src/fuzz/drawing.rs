//! SVG drawings by a grammar, nearly right.

use super::random::Random;
use std::fmt::Write;

/// A drawing; the names `b` and `c` are those that the scene of the target asks for.
pub(super) fn drawing(random: &mut Random) -> String {
    let mut text = String::new();
    if random.once_in(12) {
        text.push_str(
            "<!DOCTYPE svg [<!ENTITY e \"M0 0L9 0L9 9Z\"><!ENTITY f \"&e;&e;&e;&e;\"><!ENTITY g \"&f;&f;&f;&f;\">]>",
        );
    }
    text.push_str("<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\"");
    if !random.once_in(8) {
        let _ = write!(text, " viewBox=\"0 0 {} {}\"", size(random), size(random));
    }
    for key in ["width", "height"] {
        if random.once_in(3) {
            let unit = random.pick(&["", "mm", "%", "em", "px", "in"]);
            let _ = write!(text, " {key}=\"{}{unit}\"", size(random));
        }
    }
    if random.once_in(8) {
        let _ = write!(text, " preserveAspectRatio=\"{}\"", random.pick(&["none", "xMinYMax slice", "xMidYMid meet"]));
    }
    text.push('>');
    for _ in 0..1 + random.below(8) {
        element(&mut text, random, 0);
    }
    text.push_str("</svg>");
    text
}

fn size(random: &mut Random) -> f64 {
    if random.once_in(6) { random.hostile() } else { *random.pick(&[10.0, 100.0, 24.0, 1.0, 0.5]) }
}

fn number(random: &mut Random) -> f64 {
    if random.once_in(40) { random.hostile() } else { random.plain() }
}

fn element(text: &mut String, random: &mut Random, depth: usize) {
    let tags =
        ["path", "path", "path", "rect", "circle", "ellipse", "line", "polyline", "polygon", "use", "image", "text"];
    let groups = ["g", "g", "defs", "symbol", "clipPath", "mask", "pattern", "svg", "switch", "marker"];
    let is_group = depth < 5 && random.once_in(3);
    let tag = if is_group { random.pick(&groups) } else { random.pick(&tags) };
    // Text is slow to lay out.
    let tag = if *tag == "text" && !random.once_in(20) { &"path" } else { tag };
    let _ = write!(text, "<{tag}");
    if random.once_in(2) {
        let _ = write!(text, " id=\"{}\"", random.pick(&["b", "b", "c", "d", "e", ""]));
    }
    match *tag {
        "path" => {
            text.push_str(" d=\"");
            path(text, random);
            text.push('"');
        }
        "polyline" | "polygon" => {
            text.push_str(" points=\"");
            for _ in 0..random.below(12) {
                let _ = write!(text, "{},{} ", number(random), number(random));
            }
            text.push('"');
        }
        "use" => {
            let _ = write!(text, " xlink:href=\"#{}\"", random.pick(&["b", "c", "d", "e", "nothing"]));
        }
        "image" => {
            let file = random.pick(&["/dev/zero", "drawing.svg", "data:image/png;base64,AAAA", "../scene.toml"]);
            let _ = write!(text, " href=\"{file}\" width=\"9\" height=\"9\"");
        }
        _ => {
            for key in ["x", "y", "width", "height", "cx", "cy", "r", "rx", "ry", "x1", "y1", "x2", "y2"] {
                if random.once_in(2) {
                    let _ = write!(text, " {key}=\"{}\"", number(random));
                }
            }
        }
    }
    attributes(text, random);
    if is_group {
        text.push('>');
        for _ in 0..random.below(4) {
            element(text, random, depth + 1);
        }
        let _ = write!(text, "</{tag}>");
    } else if *tag == "text" {
        text.push_str(">Ag</text>");
    } else {
        text.push_str("/>");
    }
}

fn attributes(text: &mut String, random: &mut Random) {
    if random.once_in(3) {
        text.push_str(" transform=\"");
        for _ in 0..1 + random.below(2) {
            let (name, count) =
                *random.pick(&[("translate", 2), ("scale", 2), ("rotate", 1), ("skewX", 1), ("matrix", 6)]);
            let values: Vec<String> = (0..count).map(|_| number(random).to_string()).collect();
            let _ = write!(text, "{name}({})", values.join(" "));
        }
        text.push('"');
    }
    let others = [
        ("fill", "none"),
        ("fill", "url(#d)"),
        ("fill-rule", "evenodd"),
        ("stroke", "black"),
        ("stroke-width", "0.5"),
        ("stroke-width", "1e30"),
        ("stroke-dasharray", "1 1e-9"),
        ("stroke-linejoin", "round"),
        ("clip-path", "url(#d)"),
        ("mask", "url(#e)"),
        ("display", "none"),
        ("marker-end", "url(#e)"),
        ("style", "fill:none;stroke:red;stroke-width:2"),
        ("font-size", "10"),
    ];
    while random.once_in(3) {
        let (key, value) = random.pick(&others);
        // An attribute may stand once only.
        if !text.rsplit('<').next().is_some_and(|tag| tag.contains(&format!(" {key}="))) {
            let _ = write!(text, " {key}=\"{value}\"");
        }
    }
}

fn path(text: &mut String, random: &mut Random) {
    if random.once_in(30) {
        text.push_str("&g;");
    }
    for i in 0..1 + random.below(14) {
        let (letter, count) = if i == 0 {
            ('M', 2)
        } else {
            *random.pick(&[
                ('L', 2),
                ('l', 2),
                ('H', 1),
                ('v', 1),
                ('C', 6),
                ('s', 4),
                ('Q', 4),
                ('t', 2),
                ('A', 7),
                ('M', 2),
                ('Z', 0),
            ])
        };
        text.push(letter);
        for k in 0..count {
            let is_flag = letter == 'A' && (k == 3 || k == 4);
            let value = if is_flag { random.below(2) as f64 } else { number(random) };
            let _ = write!(text, "{value} ");
        }
    }
    if random.once_in(2) {
        text.push('Z');
    }
}
