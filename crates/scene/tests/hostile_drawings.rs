//! Drawings that would take the machine down, or read what is not theirs.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::{PLATE, scene_with, work};
use std::time::Duration;

/// Loads a scene with the element `b` of a drawing, and returns what is told.
fn told(svg: &str) -> Result<(), String> {
    let text =
        "[drawing]\nfile = 'drawing.svg'\nwidth = 1\n[[body]]\nname = 'b'\nmaterial = 'pmma'\nshape = { svg = 'b' }\n";
    scene_with(text, Some(svg), &[]).map(|_| ()).map_err(|e| e.to_string())
}

fn svg(inner: &str) -> String {
    format!("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 100 100'>\n{inner}\n</svg>")
}

const SQUARE: &str = "<rect id='b' width='50' height='50'/>";

/// Truth: each limit is named in the message, and none takes longer than two seconds (ten here: test machines are
/// busy).
#[test]
fn limits_are_told_and_quick() {
    let many = |n: usize, part: &str| part.repeat(n);
    let nested = |n: usize| format!("{}{SQUARE}{}", "<g>".repeat(n), "</g>".repeat(n));
    let doubled: String =
        (1..40).map(|i| format!("<g id='u{i}'><use href='#u{}'/><use href='#u{}'/></g>", i - 1, i - 1)).collect();
    let scribble: String =
        (0..3000).map(|i| format!("{} {} ", (i * 7919) % 101, (i * 104_729) % 97)).collect::<String>();
    let entity = |count: usize| {
        let long = "M0 0H9".repeat(15);
        let uses = "<path d='&e;'/>".repeat(count);
        format!("<!DOCTYPE svg [<!ENTITY e \"{long}{long}\">]>{}", svg(&format!("{uses}{SQUARE}")))
    };
    let cases: Vec<(&str, String, &str)> = vec![
        ("nodes", svg(&format!("{}{SQUARE}", many(250_000, "<g/>"))), "200000 nodes"),
        (
            "attributes",
            svg(&format!("<g {}/>{SQUARE}", (0..9999).map(|i| format!("a{i}='' ")).collect::<String>())),
            "100 attributes",
        ),
        ("nesting", svg(&nested(4000)), "128 deep"),
        ("doubled uses", svg(&format!("<g id='u0'>{SQUARE}</g>{doubled}")), "200000"),
        (
            "a use of itself",
            svg(&format!("<g id='u'><use href='#v'/></g><g id='v'><use href='#u'/></g>{SQUARE}")),
            "reference to itself",
        ),
        (
            "a clip of itself",
            svg(&format!("<clipPath id='c'><rect width='9' height='9' clip-path='url(#c)'/></clipPath>{SQUARE}")),
            "reference to itself",
        ),
        ("entities", entity(2000), "entities"),
        (
            "entity in entity",
            format!(
                "<!DOCTYPE svg [<!ENTITY a \"{}\"><!ENTITY b \"{}\"><!ENTITY c \"{}\">]>{}",
                many(50, "x"),
                many(200, "&a;"),
                many(200, "&b;"),
                svg("<text>&c;</text>")
            ),
            "entities",
        ),
        (
            "entities in a circle",
            format!("<!DOCTYPE svg [<!ENTITY a \"&b;\"><!ENTITY b \"&a;\">]>{}", svg("<text>&a;</text>")),
            "entities",
        ),
        ("text", svg(&format!("<text id='b'>{}</text>", many(20_000, "i"))), "5000"),
        (
            "numbers",
            svg(&format!("<path id='b' d='M0 0{}'/>", many(2_200_000, "l1 1"))),
            "numbers when its references are followed, more than 4000000",
        ),
        (
            "parts",
            svg(&format!(
                "<path id='b' d='{}'/>",
                (0..2500).map(|i| format!("M{} {}h1v1h-1z", 2 * (i % 50), 2 * (i / 50))).collect::<String>()
            )),
            "2500 parts",
        ),
        (
            "crossings of elements",
            svg(&format!(
                "<g id='b'>{}</g>",
                (0..150)
                    .map(|i| format!("<rect x='{i}' width='.5' height='150'/><rect y='{i}' width='150' height='.5'/>"))
                    .collect::<String>()
            )),
            "cross too often",
        ),
        (
            "stroked segments",
            svg(&format!("<path id='b' fill='none' stroke='red' d='M0 0{}'/>", many(30_000, "l1 1"))),
            "20000",
        ),
        ("crossings", svg(&format!("<path id='b' d='M{scribble}'/>")), "cross too often"),
        (
            "points",
            svg(&format!("<path id='b' d='M0 0{}'/>", many(40_000, "C0 9 9 9 9 0C9 -9 0 -9 0 0"))),
            "200000 points",
        ),
        ("dashes", svg("<path id='b' d='M0 0H100' fill='none' stroke='red' stroke-dasharray='1e-6'/>"), "dashes"),
        ("selectors", svg(&format!("<style>{}{{fill:red}}</style>{}", many(30, "g "), nested(60))), "selector"),
        (
            "style rules",
            svg(&format!("<style>{}</style>{}{SQUARE}", many(20_000, ".a{fill:red}"), many(20_000, "<g/>"))),
            "style rules",
        ),
        ("huge number", svg("<rect id='b' width='1e30' height='1'/>"), "1e30"),
        ("huge in a style", svg("<path id='b' d='M0 0H1' style='stroke:red;stroke-width:1e30px'/>"), "1e30"),
        (
            "huge by transforms",
            svg("<g transform='scale(1e8)'><g transform='scale(1e8)'><rect id='b' width='50' height='50'/></g></g>"),
            "times the size",
        ),
        (
            "wide stroke",
            svg("<path id='b' d='M0 0H10' fill='none' stroke='red' stroke-width='9e8'/>"),
            "times the size",
        ),
        (
            "huge height",
            format!("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 9 9' height='3.4028235e38'>{SQUARE}</svg>"),
            "3.4028235e38",
        ),
        ("no size", format!("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 1e-30 1'>{SQUARE}</svg>"), "viewBox"),
        ("zero width", format!("<svg xmlns='http://www.w3.org/2000/svg' width='0' height='5'>{SQUARE}</svg>"), "width"),
    ];
    for (what, drawing, words) in cases {
        let start = work();
        let told = told(&drawing).expect_err(what);
        assert!(told.contains(words) && told.contains("drawing.svg"), "{what}: {}", &told[..told.len().min(400)]);
        assert!(work() - start < Duration::from_secs(10), "{what} took {:?}", work() - start);
    }
}

/// What is strange but small is drawn.
#[test]
fn strange_drawings_load() {
    let entity = "<!DOCTYPE svg [<!ENTITY w \"50\"><!ENTITY ns \"http://www.w3.org/2000/svg\">]>\
                  <svg xmlns='&ns;' viewBox='0 0 100 100'><rect id='b' width='&w;' height='50'/></svg>";
    let cases = [
        entity.to_owned(),
        svg(&format!("<g transform='matrix(0 0 0 0 0 0)'><rect width='5' height='5'/></g>{SQUARE}")),
        svg(&format!("<path d='M0 0L nonsense'/><rect width='-5' height='5'/>{SQUARE}")),
        svg(&format!("<g fill='#1e9999'><a href='#top'>{SQUARE}</a></g>")),
        svg(&format!("<linearGradient id='g'><stop/></linearGradient><g fill='url(#g)'>{SQUARE}</g>")),
        svg(&format!("{}{SQUARE}{}", "<g>".repeat(100), "</g>".repeat(100))),
    ];
    for drawing in cases {
        told(&drawing).unwrap_or_else(|e| panic!("{drawing}: {e}"));
    }
}

/// Truth: a pipe that nobody writes into blocks whoever opens it, and a device without end fills the memory.
#[cfg(unix)]
#[test]
fn nothing_outside_the_drawing_is_opened() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe.svg");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let pipe = pipe.display();
    let (sender, receiver) = std::sync::mpsc::channel();
    let targets = [format!("{pipe}"), format!("file://{pipe}"), "/dev/zero".to_owned(), "pipe.svg".to_owned()];
    let mut drawings: Vec<String> = Vec::new();
    for target in &targets {
        drawings.push(svg(&format!("<image href='{target}' width='9' height='9'/>{SQUARE}")));
        drawings.push(svg(&format!("<use href='{target}#x'/>{SQUARE}")));
        drawings.push(svg(&format!("<style>@import '{target}'; @font-face {{ src: url({target}) }}</style>{SQUARE}")));
        drawings
            .push(svg(&format!("<filter id='f'><feImage href='{target}'/></filter><g filter='url(#f)'>{SQUARE}</g>")));
        drawings.push(format!(
            "<!DOCTYPE svg SYSTEM '{target}' [<!ENTITY x SYSTEM '{target}'>]>{}",
            svg(&format!("<desc>&x;</desc>{SQUARE}"))
        ));
        let inner = svg(&format!("<image href='{target}' width='9' height='9'/>"));
        let encoded: String = inner.bytes().map(|b| format!("%{b:02x}")).collect();
        drawings.push(svg(&format!("<image href='data:image/svg+xml,{encoded}' width='9' height='9'/>{SQUARE}")));
    }
    let file = format!("[drawing]\nfile = '{pipe}'\nwidth = 1\n[[crack]]\nline = {{ svg = 'c' }}\n{PLATE}");
    let worker = std::thread::spawn(move || {
        // An external entity may be an error, but it is not read.
        drawings.iter().for_each(|drawing| drop(told(drawing)));
        let refused = scene_with(&file, None, &[]).unwrap_err().to_string();
        sender.send(refused).unwrap();
    });
    let refused = receiver.recv_timeout(Duration::from_secs(60)).expect("something waits for a pipe or a device");
    assert!(refused.contains("not a regular file") && refused.contains("pipe.svg"), "{refused}");
    worker.join().unwrap();
}
