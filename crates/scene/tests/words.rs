//! Values of the wrong kind: each is told in the words of the guide, never in those of the deserializer.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::{PLATE, scene_with};

/// What is said of a plate with `rest` below it.
fn told(rest: &str) -> String {
    match scene_with(&format!("{PLATE}{rest}"), None, &[]) {
        Ok(_) => panic!("accepted: {rest}"),
        Err(error) => {
            assert!(error.line().is_some(), "{rest}: {error}");
            format!("{} | {}", error.message, error.remedy)
        }
    }
}

/// What is said of top-level keys, which stand above the first table.
fn told_on_top(keys: &str) -> String {
    let error = scene_with(&format!("{keys}\n{}", PLATE), None, &[]).expect_err(keys);
    assert_eq!(error.line(), Some(1), "{error}");
    format!("{} | {}", error.message, error.remedy)
}

#[test]
fn a_value_in_place_of_a_list_of_tables_is_shown_how_to_write_it() {
    for array in [
        "material",
        "region",
        "toughness",
        "crack",
        "flaws",
        "guide",
        "collider",
        "load",
        "support",
        "initial_velocity",
    ] {
        for keys in [format!("{array} = \"pmma\""), format!("{array} = 3"), format!("{array} = {{ name = \"a\" }}")] {
            let words = told_on_top(&keys);
            assert!(words.contains(&format!("each begins with `[[{array}]]`")), "{words}");
            assert!(words.contains(" below it"), "{words}");
        }
        let words = told(&format!("[{array}]\nname = 'a'\n"));
        assert!(words.contains(&format!("`[{array}]` is a single table")), "{words}");
    }
    assert!(told_on_top("material = \"pmma\"").contains("the material of a body is a key of `[[body]]`"));
}

#[test]
fn a_value_of_the_wrong_kind_is_told_what_the_key_takes() {
    let on_top = [
        ("gravity = [0, -9.81, 0]", "two numbers, `[x, y]`", "Acceleration of gravity"),
        ("gravity = -9.81", "two numbers, `[x, y]`", "m/s²"),
        ("gravity = [0, \"-9.81\"]", "a number, without quotes", ""),
        ("plane = 2", "`plane` is 2", "thin plates"),
        ("name = 5", "text in quotes", "prefix of the files"),
        ("drawing = \"a.svg\"", "a table of keys", "SVG drawing"),
        ("grid = 0.1", "a table of keys", "Resolution"),
        ("output = \"glb\"", "a table of keys", "meshes"),
    ];
    let mut wrong = Vec::new();
    for (keys, takes, means) in on_top {
        let words = told_on_top(keys);
        if !words.contains(takes) || !words.contains(means) {
            wrong.push(format!("{keys}: {words}"));
        }
    }
    let below = [
        ("[grid]\nparticle_spacing = \"0.1\"\n", "a number, without quotes", "neighbouring particles"),
        ("[grid]\nparticle_spacing = [0.1, 0.1]\n", "a number, without quotes", "neighbouring particles"),
        ("[frames]\nrange = 48\n", "text in quotes", "1-48"),
        ("[frames]\nfirst = 1.5\n", "a whole number", "first frame"),
        ("[growth]\nenabled = \"yes\"\n", "`true` or `false`", "cracks grow"),
        ("[growth]\nspeed_keyframes = [10, 1]\n", "two numbers, `[x, y]`", ""),
        ("[solver]\ntime_step = true\n", "\"auto\" or a number of seconds", ""),
        ("[solver]\ntransfer = { flip = \"a lot\" }\n", "a number, without quotes", ""),
        (
            "[solver]\ntransfer = 0.95\n",
            "`solver.transfer` is 0.95, but it takes one of `\"pic\"`, `{ flip = ... }`",
            "xpic",
        ),
        (
            "[solver]\ntransfer = \"flip\"\n",
            "`solver.transfer` is the text \"flip\", but it takes one of",
            "{ flip = 0.95 }",
        ),
        (
            "[[region]]\nmaterial = 'glass'\nshape = \"circle\"\n",
            "`region[0].shape` is the text \"circle\"",
            "Where it is",
        ),
        ("gravity = [0, -9.81]\n", "unknown key `gravity` of `body[0]`", "above the first heading"),
        ("[grid]\nparticle_spacing = 0,25\n", "not valid TOML", "with a point"),
        ("[[load]]\nselect = { edge = top }\nforce = [0, 1]\n", "not valid TOML", "in quotes"),
        ("[[load]]\nforce = [0, 40 MN]\n", "not valid TOML", "without units"),
        ("[drawing]\nfile = \"C:\\drawings\\wall.svg\"\n", "not valid TOML", "in single quotes"),
        ("[[material]]\nname = \"m\nbase = 'pmma'\n", "not valid TOML", "a quote before text"),
        ("[[grid]]\nparticle_spacing = 0.1\n", "there is only one `grid`", "write `[grid]`"),
        ("[[frames]]\nrange = \"1-3\"\n", "there is only one `frames`", "write `[frames]`"),
        ("[[material]]\nname = 'm'\nbase = 'm'\n", "material `m` is its own base", "`base = \"pmma\"`"),
        (
            "[[crack]]\nguide = 'path'\nline = [[0, 0], [0, 1]]\ntips = 'end'\n",
            "no guide `path`",
            "draw one with `[[guide]]`",
        ),
        ("[output]\nformats = \"glb\"\n", "a list in brackets", "glb"),
        ("[output]\nformats = [1]\n", "`output.formats[0]` is 1", ""),
        ("[[crack]]\nline = \"notch\"\n", "points [[x, y], ...] or { svg = \"id\" }", ""),
        ("[[crack]]\nline = [0, 0, 5, 5]\n", "two numbers, `[x, y]`", ""),
        ("[[crack]]\nline = { svg = 3 }\n", "text in quotes", ""),
        ("[[crack]]\nline = { svg = \"a\", points = [[0, 0]] }\n", "exactly one key", "Its line"),
        ("[[flaws]]\ncount = 2.5\nlength = 1\n", "a whole number", "Number of flaws"),
        ("[[load]]\nforce = 1e6\n", "two numbers, `[x, y]`", "Total force"),
        ("[[load]]\nselect = \"top\"\nforce = [0, 1]\n", "a table of keys", ""),
        ("[[load]]\nselect = { edge = 1 }\nforce = [0, 1]\n", "`load[0].select.edge` is 1", ""),
        ("[[load]]\nselect = { near = [1, 2], radius = 1 }\nforce = [0, 1]\n", "two numbers, `[x, y]`", ""),
        (
            "[[support]]\nfix = true\n",
            "`support[0].fix` is true, but it takes one of `\"x\"`, `\"y\"`, `\"both\"`",
            "held still",
        ),
        ("[[support]]\nvelocity_x = [1, 0]\n", "a number", "Velocity along x"),
        ("[[collider]]\nshape = \"floor\"\n", "`collider[0].shape`", ""),
        (
            "[[region]]\nmaterial = 'glass'\nshape = { polygon = [[0, 0], [1, 0], [0, 1]], holes = [] }\n",
            "is a table of `holes`, `polygon`, but it takes one of",
            "`holes` is a key of `polygon`",
        ),
        ("[[collider]]\nshape = { }\n", "one of `{ half_plane = ... }`", ""),
        ("[[collider]]\nshape = { disc = 1 }\n", "a table of keys", ""),
        ("[[collider]]\nshape = { disc = { radius = 1 }, box = 2 }\n", "one of `{ half_plane = ... }`", ""),
        ("[[region]]\nmaterial = 1\nshape = { circle = { radius = 1 } }\n", "text in quotes", ""),
        ("[[region]]\nmaterial = 'glass'\nshape = { circle = 3 }\n", "a table of keys", ""),
        ("[[material]]\nname = 'a'\nplasticity = 3\n", "true, false or a table of values", ""),
    ];
    let raw = ["invalid type", "invalid length", "string only", "f64", "u32", "struct", "variant", "untagged"];
    for (rest, takes, means) in below {
        let words = told(rest);
        if !words.contains(takes) || !words.contains(means) || raw.iter().any(|raw| words.contains(raw)) {
            wrong.push(format!("{rest}: {words}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
