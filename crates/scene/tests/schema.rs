//! The JSON schema says the ranges that the program checks.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::{Folder, PLATE, paint};
use fissure_scene::{LoadError, load, schema};
use serde_json::Value;

/// A scene with one item of each array, whose keys may be overridden one at a time.
fn scene() -> String {
    let rest = "
angular_velocity = 1
[drawing]
file = 'drawing.svg'
width = 20
[[material]]
name = 'mine'
base = 'snow'
[[region]]
material = 'mine'
shape = { circle = { radius = 1 } }
[[toughness]]
shape = { circle = { radius = 1 } }
factor = 2
[[crack]]
name = 'notch'
line = [[-10, 0], [-5, 0]]
guide = 'path'
[[guide]]
name = 'path'
line = [[-5, 0], [5, 1]]
[[flaws]]
length = 1
count = 1
[[collider]]
shape = { disc = { center = [0, 20], radius = 1 } }
keyframes = [{ time = 0 }]
[[load]]
force = [1, 0]
[[support]]
velocity_x = 0
[[initial_velocity]]
velocity = [0, 0]
[[contact.pairs]]
materials = ['mine', 'mine']
friction = 0
";
    format!("{PLATE}{rest}")
}

/// A number somewhere in the schema: how it is overridden, with `#` in place of the number, and its bounds.
struct Number {
    set: String,
    bounds: serde_json::Map<String, Value>,
}

/// All bounded numbers of the schema below `here`, which is written as `form` with `#` in its place.
fn numbers(root: &Value, here: &Value, form: &str, found: &mut Vec<Number>) {
    if let Some(name) = here["$ref"].as_str() {
        return numbers(root, root.pointer(&name[1..]).unwrap(), form, found);
    }
    for branch in ["anyOf", "oneOf"].iter().filter_map(|key| here[key].as_array()).flatten() {
        numbers(root, branch, form, found);
    }
    for (key, value) in here["properties"].as_object().into_iter().flatten() {
        // Tables of the file are reached by path, those within a value are written in braces.
        let inner = match form.split_once('=') {
            None => format!("{}{key}=#", if form.is_empty() { String::new() } else { format!("{form}.") }),
            Some((path, "#")) => format!("{path}.{key}=#"),
            Some((path, "[#]")) => format!("{path}.0.{key}=#"),
            Some(_) => form.replace('#', &format!("{{ {key} = # }}")),
        };
        numbers(root, value, &inner, found);
    }
    if let Some(items) = here.get("items").filter(|items| items.is_object()) {
        let is_pair = here["maxItems"] == 2;
        numbers(root, items, &form.replace('#', if is_pair { "[#, 0]" } else { "[#]" }), found);
    }
    if let Some([over, value]) = here["prefixItems"].as_array().map(Vec::as_slice) {
        numbers(root, over, &form.replace('#', "[#, 0]"), found);
        numbers(root, value, &form.replace('#', "[0, #]"), found);
    }
    let keywords = ["minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum"];
    let bounds: serde_json::Map<_, _> =
        keywords.iter().filter_map(|key| Some(((*key).to_owned(), here.get(key)?.clone()))).collect();
    // Integers are bounded by counts and by each other.
    if here["type"].to_string().contains("number") {
        found.push(Number { set: form.to_owned(), bounds });
    }
}

/// An override that sets a number together with what it needs to mean anything.
fn with_company(set: &str) -> String {
    let shapes = [
        (".rectangle.min=", "{ rectangle = { min = [#, 0], max = [10, 10] } }"),
        (".rectangle.max=", "{ rectangle = { min = [-10, -10], max = [#, 1] } }"),
        (".box.min=", "{ box = { min = [#, 0], max = [10, 10] } }"),
        (".box.max=", "{ box = { min = [-10, -10], max = [#, 1] } }"),
        (".circle.center=", "{ circle = { center = [#, 0], radius = 1 } }"),
        (".circle.radius=", "{ circle = { radius = # } }"),
        (".disc.center=", "{ disc = { center = [#, 0], radius = 1 } }"),
        (".disc.radius=", "{ disc = { center = [0, 20], radius = # } }"),
        (".half_plane.point=", "{ half_plane = { point = [#, 0] } }"),
        (".polygon=", "{ polygon = [[#, 0], [1, 0], [0, 1]] }"),
        (".polygon.exterior=", "{ polygon = { exterior = [[#, 0], [1, 0], [0, 1]] } }"),
        (
            ".polygon.holes=",
            "{ polygon = { exterior = [[-9, -9], [9, -9], [0, 9]], holes = [[[#, 0], [1, 0], [0, 1]]] } }",
        ),
        (".line=", "[[#, 0], [5, 1]]"),
        (".line.points=", "{ points = [[#, 0], [5, 1]] }"),
        (".select.near=", "{ near = [[#, 0]], radius = 1 }"),
        (".select.radius=", "{ near = [[0, 0]], radius = # }"),
        (".plasticity.critical_compression=", "{ critical_compression = # }"),
        (".plasticity.critical_stretch=", "{ critical_stretch = # }"),
        (".plasticity.hardening=", "{ hardening = # }"),
        (".transfer.flip=", "{ flip = # }"),
    ];
    for (key, value) in shapes {
        if let Some((owner, _)) = set.split_once(key) {
            let own = key.strip_prefix('.').and_then(|key| key.split(['.', '=']).next()).unwrap();
            // Of a shape the whole is replaced, of other tables their key.
            let keeps_key = ["line", "select", "plasticity", "transfer"].contains(&own);
            return if keeps_key { format!("{owner}.{own}={value}") } else { format!("{owner}={value}") };
        }
    }
    let alone = [
        ("drawing.metres_per_unit=", "drawing={ file = 'drawing.svg', metres_per_unit = # }"),
        ("toughness.0.black=", "toughness=[{ image = 'a.png', black = # }]"),
        ("toughness.0.white=", "toughness=[{ image = 'a.png', white = # }]"),
        ("toughness.0.min=", "toughness=[{ image = 'a.png', min = [#, 0], max = [10, 10] }]"),
        ("toughness.0.max=", "toughness=[{ image = 'a.png', min = [-10, -10], max = [#, 1] }]"),
        ("flaws.0.density=", "flaws=[{ length = 1, density = # }]"),
        ("load.0.traction=", "load=[{ select = { edge = 'left' }, traction = [#, 0] }]"),
        ("load.0.pressure=", "load=[{ select = { edge = 'left' }, pressure = # }]"),
        ("load.0.per_point.0.at=", "load=[{ per_point = [{ at = [#, 0], force = [0, 0] }] }]"),
        ("support.0.displacement_x=", "support=[{ displacement_x = #, curve = [[0, 0], [1e8, 1]] }]"),
        ("support.0.displacement_y=", "support=[{ displacement_y = #, curve = [[0, 0], [1e8, 1]] }]"),
        ("load.0.per_point.0.force=", "load=[{ per_point = [{ at = [0, 0], force = [#, 0] }] }]"),
    ];
    let found = alone.iter().find(|(key, _)| set.starts_with(key));
    found.map_or_else(|| set.to_owned(), |(_, whole)| (*whole).to_owned())
}

/// Whether the program says of `value` that it is out of the range of its key.
fn is_out_of_range(folder: &Folder, argument: &str, value: f64) -> bool {
    // What is told of other numbers, which this one makes impossible, does not count.
    let told = |error: &LoadError| {
        let number = error.message.rsplit(' ').next().and_then(|word| word.parse::<f64>().ok());
        let is_same = number.is_some_and(|number| (number - value).abs() <= 1e-12 * value.abs() + f64::MIN_POSITIVE);
        is_same && error.remedy.starts_with("it must be")
    };
    load(&folder.path(), &[argument.to_owned()]).is_err_and(|error| told(&error))
}

/// Truth: the program itself, at each bound, just within and just beyond.
#[test]
fn the_schema_bounds_every_number_as_the_program_does() {
    let square =
        r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 2 2"><rect id="s" width="2" height="2"/></svg>"#;
    let (folder, root) = (Folder::new(&scene(), Some(square)), schema());
    paint(&folder.file("a.png"), png::ColorType::Grayscale, png::BitDepth::Eight, 4, &[9; 16]);
    load(&folder.path(), &[]).unwrap();
    let mut found = Vec::new();
    numbers(&root, &root, "", &mut found);
    assert!(found.len() > 60, "only {} numbers are found in the schema", found.len());
    let mut wrong = Vec::new();
    for Number { set, bounds } in &found {
        // Any length will do for a direction.
        if bounds.is_empty() && !set.contains(".normal=") {
            wrong.push(format!("{set} has no bounds"));
        }
        for (keyword, bound) in bounds {
            let bound = bound.as_f64().unwrap();
            let beyond = if keyword.to_lowercase().ends_with("minimum") { bound.next_down() } else { bound.next_up() };
            for (value, is_refused) in [(bound, keyword.starts_with("exclusive")), (beyond, true)] {
                let argument = with_company(set).replace('#', &format!("{value:e}"));
                if is_out_of_range(&folder, &argument, value) != is_refused {
                    let told = load(&folder.path(), std::slice::from_ref(&argument)).map(|_| "loads");
                    let told = told.map_err(|error| error.to_string());
                    wrong.push(format!("{argument}, {keyword} {bound:e}: {told:?}"));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{} of {}:\n{}", wrong.len(), found.len(), wrong.join("\n"));
}
