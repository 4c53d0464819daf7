//! What was typed. What it means is decided by the stages.

use crate::frame_set::FrameSet;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand, ValueEnum, ValueHint, value_parser};
use fissure_preview::SIZES;
use fissure_scene::{Cut, Format, Part, UpAxis, Wish};
use std::path::PathBuf;

/// Cracked mesh sequences from a drawing.
#[derive(Debug, Parser)]
#[command(
    name = "fissure",
    version = version(),
    about = "Draw a body and its cracks; get cracked, extruded mesh sequences",
    after_help = "Examples:\n  fissure new my-crack             write a scene to start from\n  fissure run my-crack/scene.toml  simulate it and write its meshes\n  \
                  fissure run plate.svg --material glass   the same of a drawing with a body and a crack in it\n\n\
                  Exit codes: 0 ok, 2 usage or scene, 3 file, 4 numerical failure (do not retry), 75 interrupted (run again to resume)",
    subcommand_required = true,
    arg_required_else_help = true,
    max_term_width = 100
)]
pub(crate) struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub(crate) command: Command,
    /// How to speak about it.
    #[command(flatten)]
    pub(crate) talk: TalkArguments,
}

/// The stages.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Write a commented scene that runs.
    #[command(after_help = "Example:\n  fissure new my-crack && fissure run my-crack/scene.toml")]
    New(NewArguments),
    /// Validate a scene and say what it will cost, without running it.
    #[command(after_help = "Example:\n  fissure check examples/pull/scene.toml --set grid.particle_spacing=0.0625")]
    Check(CheckArguments),
    /// Simulate a scene and write its meshes while the solver goes on.
    ///
    /// Interrupted (Ctrl-C), the same command resumes.
    #[command(after_help = "Example:\n  fissure run examples/pull/scene.toml --formats glb,ply --output pull-meshes")]
    Run(RunArguments),
    /// Simulate a scene and write the take only; `fissure post` makes meshes of it later.
    ///
    /// Interrupted (Ctrl-C), the same command resumes.
    #[command(after_help = "Example:\n  fissure sim examples/pull/scene.toml && fissure post out/pull/pull.take")]
    Sim(SimArguments),
    /// Write the meshes of a take without simulating again.
    #[command(
        after_help = "Example:\n  fissure post out/pull/pull.take --thickness 0.2 --formats glb,ply --frames 1-45x2"
    )]
    Post(PostArguments),
    /// Draw a run: frames as PNG, a contact sheet and a GIF, or a page to turn it about in a browser.
    #[command(
        after_help = "Examples:\n  fissure preview out/pull                                  what a run looks like\n  \
                      fissure preview out/pull --color stress --theme dark      where it is pulled and pressed\n  \
                      fissure preview out/pull --frames 8,16,48 --pictures sheet  three frames side by side\n  \
                      fissure preview out/pull --html                           a page to turn it about"
    )]
    Preview(PreviewArguments),
    /// Compute problems with known solutions and print what comes out beside what should.
    ///
    /// A missed target is printed as such and is no failure.
    #[command(after_help = "Examples:\n  fissure verify edge-crack               one case\n  \
                      fissure verify edge-crack --places 32   wherever it lies on the grid\n  \
                      fissure verify all                      the full table")]
    Verify(VerifyArguments),
    /// Run a scene at three resolutions, and print what changes: order, extrapolated values, distance of paths.
    ///
    /// Cells are four times, twice and once as large as the scene asks for. Writes no take and no meshes.
    #[command(after_help = "Example:\n  fissure converge examples/pull/scene.toml --csv pull-convergence.csv")]
    Converge(ConvergeArguments),
    /// Measure accuracy against time, and draw it: tables and figures for `docs/charts`.
    ///
    /// Each measurement is on the disk as soon as it is made. Interrupted, the same command goes on.
    #[command(
        after_help = "Examples:\n  fissure chart --quick            the shape of every chart, in a few minutes\n  \
                      fissure chart accuracy           one chart in full\n\n\
                      Times are those of all threads together; other programs that run at the same time still slow them down."
    )]
    Chart(ChartArguments),
    /// Print the JSON schema of scene files, for editors.
    #[command(after_help = "Example:\n  fissure schema > scene.schema.json")]
    Schema,
    /// Print completions for a shell.
    #[command(
        after_help = "Examples:\n  fissure completions bash > ~/.local/share/bash-completion/completions/fissure\n  \
                      fissure completions zsh > ~/.zfunc/_fissure\n  \
                      fissure completions fish > ~/.config/fish/completions/fissure.fish\n  \
                      fissure completions powershell >> $PROFILE"
    )]
    Completions(CompletionsArguments),
    /// Write manual pages into a folder.
    #[command(after_help = "Example:\n  fissure man ~/.local/share/man/man1 && man fissure-run")]
    Man(ManArguments),
}

/// Version, and the commit the program is built from where it is known.
fn version() -> &'static str {
    if env!("FISSURE_REVISION").is_empty() {
        env!("CARGO_PKG_VERSION")
    } else {
        concat!(env!("CARGO_PKG_VERSION"), " (", env!("FISSURE_REVISION"), ")")
    }
}

/// Arguments of `completions`.
#[derive(Debug, Args)]
pub(crate) struct CompletionsArguments {
    /// The shell.
    pub(crate) shell: clap_complete::Shell,
}

/// Arguments of `man`.
#[derive(Debug, Args)]
pub(crate) struct ManArguments {
    /// Folder to write the pages into; made when missing.
    #[arg(value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(crate) directory: PathBuf,
}

/// Arguments of `new`.
#[derive(Debug, Args)]
pub(crate) struct NewArguments {
    /// Folder to write `scene.toml` into; made when missing.
    #[arg(default_value = ".", value_hint = ValueHint::DirPath)]
    pub(crate) directory: PathBuf,
}

/// The scene and what overrides it.
#[derive(Debug, Args)]
pub(crate) struct SceneArguments {
    /// The scene file, or the folder it is in, or an SVG drawing whose elements or layers are called body, crack,
    /// guide, collider.
    #[arg(value_hint = ValueHint::AnyPath)]
    pub(crate) scene: PathBuf,
    /// Of a drawing: what its bodies are made of, glass, pmma, snow or jello.
    #[arg(long, value_name = "NAME")]
    pub(crate) material: Option<String>,
    /// Of a drawing: metres that its width spans [default: as its units say].
    #[arg(long, value_name = "METRES", allow_negative_numbers = true, value_parser = parse_length)]
    pub(crate) width: Option<f64>,
    /// Override one key of the scene file; may be repeated. The value is TOML; a bare word is a string.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub(crate) overrides: Vec<String>,
    /// Choose the particle spacing so that the highest K of each tip is within so much, e.g. 2%; before what the scene
    /// says.
    #[arg(long, value_name = "PER CENT", value_parser = Wish::accuracy, conflicts_with = "budget")]
    pub(crate) accuracy: Option<Wish>,
    /// Choose the finest particle spacing that takes no longer than so long, e.g. 30s, 5min, 2h, meshes included;
    /// before what the scene says.
    #[arg(long, value_name = "TIME", value_parser = Wish::budget)]
    pub(crate) budget: Option<Wish>,
    /// Fail when there are warnings, before anything is computed.
    #[arg(long)]
    pub(crate) strict: bool,
}

impl SceneArguments {
    /// What is wanted of the resolution on the command line, if anything is.
    pub(crate) fn wish(&self) -> Option<Wish> {
        self.accuracy.or(self.budget)
    }
}

/// Where a take goes and what to do with one that is there.
#[derive(Debug, Args)]
pub(crate) struct TakeArguments {
    /// Folder to write into [default: out/NAME, NAME being the scene's name].
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(crate) output: Option<PathBuf>,
    /// Also write tables, finer than frames, beside the take: looks (J and K of each tip at every look), contours (the
    /// same over five radii), energy (the budget), supports (load over displacement); without `=` all of them.
    #[arg(long, value_name = "WHICH,..", value_enum, value_delimiter = ',', num_args = 0..=1, require_equals = true,
          default_missing_value = "looks,contours,energy,supports", hide_possible_values = true)]
    pub(crate) tables: Vec<TableName>,
    /// Start afresh: remove the take and the meshes of this scene's name that are in the output folder.
    #[arg(long)]
    pub(crate) overwrite: bool,
    /// Threads to compute with [default: one per core]. The results do not depend on it.
    #[arg(long, value_name = "N", value_parser = value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
}

/// A table beside the take.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum TableName {
    /// J and K of each tip at every look.
    Looks,
    /// The same over five radii.
    Contours,
    /// The energy budget.
    Energy,
    /// Load over displacement of supports.
    Supports,
}

/// What meshes to write.
#[derive(Debug, Clone, Default, Args)]
pub(crate) struct MeshArguments {
    /// File formats: glb, ply, obj, usda, vtk, svg, glb_sequence, glb_rigid [default: as in the scene].
    #[arg(long, value_name = "FORMAT,..", value_delimiter = ',', value_parser = words::<Format>(&["glb", "ply", "obj", "usda", "vtk", "svg", "glb_sequence", "glb_rigid"]), hide_possible_values = true)]
    pub(crate) formats: Vec<Format>,
    /// Parts of the scene: cracked, body, faces, collider, particles [default: as in the scene].
    #[arg(long, value_name = "PART,..", value_delimiter = ',', value_parser = words::<Part>(&["cracked", "body", "faces", "collider", "particles"]), hide_possible_values = true)]
    pub(crate) parts: Vec<Part>,
    /// Thickness of the solids in metres [default: as in the scene].
    #[arg(long, value_name = "METRES", allow_negative_numbers = true, value_parser = parse_length)]
    pub(crate) thickness: Option<f64>,
    /// Up axis of PLY files, y or z; glTF is always y up [default: as in the scene].
    #[arg(long, value_name = "AXIS", value_parser = words::<UpAxis>(&["y", "z"]), hide_possible_values = true)]
    pub(crate) up: Option<UpAxis>,
    /// Where the material is cut: opening, as it is in each frame, or rest, so that vertices keep their numbers until a
    /// crack grows [default: as in the scene].
    #[arg(long, value_name = "WHERE", value_parser = words::<Cut>(&["opening", "rest"]), hide_possible_values = true)]
    pub(crate) cut: Option<Cut>,
}

/// Arguments of `check`.
#[derive(Debug, Args)]
pub(crate) struct CheckArguments {
    #[command(flatten)]
    pub(crate) scene: SceneArguments,
    /// Thickness of the solids in metres [default: as in the scene; of a drawing a tenth of their size].
    #[arg(long, value_name = "METRES", allow_negative_numbers = true, value_parser = parse_length)]
    pub(crate) thickness: Option<f64>,
}

/// Arguments of `run`.
#[derive(Debug, Args)]
pub(crate) struct RunArguments {
    #[command(flatten)]
    pub(crate) scene: SceneArguments,
    #[command(flatten)]
    pub(crate) take: TakeArguments,
    #[command(flatten)]
    pub(crate) mesh: MeshArguments,
    /// Frames to write meshes of, e.g. `1-45x2` (every second) or `1,10,20-30`; simulation stops at the last of them.
    #[arg(long, value_name = "RANGE")]
    pub(crate) frames: Option<FrameSet>,
    /// Draw the run at its end, as `fissure preview` does, and make its page.
    #[arg(long)]
    pub(crate) preview: bool,
}

/// Arguments of `sim`.
#[derive(Debug, Args)]
pub(crate) struct SimArguments {
    #[command(flatten)]
    pub(crate) scene: SceneArguments,
    /// Thickness of the solids in metres [default: as in the scene; of a drawing a tenth of their size].
    #[arg(long, value_name = "METRES", allow_negative_numbers = true, value_parser = parse_length)]
    pub(crate) thickness: Option<f64>,
    #[command(flatten)]
    pub(crate) take: TakeArguments,
    /// Frames wanted, e.g. `1-45`; simulation stops at the last of them (the take holds all frames up to it).
    #[arg(long, value_name = "RANGE")]
    pub(crate) frames: Option<FrameSet>,
}

/// Arguments of `post`.
#[derive(Debug, Args)]
pub(crate) struct PostArguments {
    /// The take, a folder ending in `.take`, or the folder that holds it.
    #[arg(value_hint = ValueHint::DirPath)]
    pub(crate) take: PathBuf,
    #[command(flatten)]
    pub(crate) mesh: MeshArguments,
    /// Override one key of the scene's output, e.g. `output.opening.factor=2`; may be repeated. The value is TOML; a
    /// bare word is a string.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub(crate) overrides: Vec<String>,
    /// Frames to write meshes of, e.g. `1-45x2` or `1,10,20-30` [default: all].
    #[arg(long, value_name = "RANGE")]
    pub(crate) frames: Option<FrameSet>,
    /// Folder to write into [default: the folder that holds the take].
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(crate) output: Option<PathBuf>,
    /// Threads to compute with [default: one per core].
    #[arg(long, value_name = "N", value_parser = value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
}

/// Arguments of `preview`.
#[derive(Debug, Args)]
pub(crate) struct PreviewArguments {
    /// The output folder of a run, or a take, a folder ending in `.take`.
    #[arg(value_name = "RUN", value_hint = ValueHint::DirPath)]
    pub(crate) run: PathBuf,
    /// What to make: frames (a PNG each), sheet (a PNG of up to 12 frames side by side), gif [default: all of them;
    /// with `--html` none].
    #[arg(long, value_name = "WHAT,..", value_delimiter = ',', value_enum, hide_possible_values = true)]
    pub(crate) pictures: Vec<PictureKind>,
    /// Make a page of the meshes and curves, one file for any browser, without a network.
    #[arg(long)]
    pub(crate) html: bool,
    /// Frames to draw, e.g. `1-45x2` or `1,10,20-30` [default: all].
    #[arg(long, value_name = "RANGE")]
    pub(crate) frames: Option<FrameSet>,
    /// What colours mean: fragment, stress (the largest principal one) or speed.
    #[arg(long, value_name = "WHAT", value_enum, hide_possible_values = true, default_value_t = ColorBy::Fragment)]
    pub(crate) color: ColorBy,
    /// Light or dark.
    #[arg(long, value_name = "THEME", value_enum, hide_possible_values = true, default_value_t = ThemeName::Light)]
    pub(crate) theme: ThemeName,
    /// Width of a picture in pixels; its height follows from what is in view.
    #[arg(long, value_name = "PIXELS", default_value_t = DEFAULT_SIZE, value_parser = value_parser!(u32).range(i64::from(*SIZES.start())..=i64::from(*SIZES.end())))]
    pub(crate) size: u32,
    /// Degrees by which the view is turned about the upright axis; below 0 to see right sides, above 0 left ones.
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0, allow_negative_numbers = true, value_parser = parse_turn)]
    pub(crate) yaw: f64,
    /// Degrees by which the eye is above the middle; below 0 to look from below.
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0, allow_negative_numbers = true, value_parser = parse_turn)]
    pub(crate) pitch: f64,
    /// Folder to write into [default: `preview` in the folder that holds the take].
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(crate) output: Option<PathBuf>,
    /// Threads to draw with [default: one per core]. The pictures do not depend on it.
    #[arg(long, value_name = "N", value_parser = value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
}

impl PreviewArguments {
    /// All pictures and the page of the run in a folder.
    pub(crate) fn everything_of(run: PathBuf) -> Self {
        Self {
            run,
            pictures: vec![PictureKind::Frames, PictureKind::Sheet, PictureKind::Gif],
            html: true,
            frames: None,
            color: ColorBy::Fragment,
            theme: ThemeName::Light,
            size: DEFAULT_SIZE,
            yaw: 0.0,
            pitch: 0.0,
            output: None,
            threads: None,
        }
    }
}

/// Width of a picture where none is asked for [pixels].
const DEFAULT_SIZE: u32 = 960;

/// A kind of picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum PictureKind {
    /// A PNG per frame.
    Frames,
    /// A PNG of some frames side by side.
    Sheet,
    /// An animated GIF.
    Gif,
    /// A page; it has an option of its own.
    #[value(skip)]
    Page,
}

/// What colours mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ColorBy {
    /// The fragment.
    Fragment,
    /// The largest principal stress.
    Stress,
    /// The speed.
    Speed,
}

/// Light or dark.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ThemeName {
    /// For white pages.
    Light,
    /// For dark pages.
    Dark,
}

/// Arguments of `verify`.
#[derive(Debug, Args)]
pub(crate) struct VerifyArguments {
    /// The case, or `all`.
    pub(crate) name: Option<String>,
    /// Print the names of all cases.
    #[arg(long)]
    pub(crate) list: bool,
    /// Run all cases.
    #[arg(long, conflicts_with = "name")]
    pub(crate) all: bool,
    /// Resolution: cells per characteristic length, which `--list` names for each case [default: that of the
    /// targets, at several places what `--list` names].
    #[arg(long, value_name = "N", value_parser = parse_cells)]
    pub(crate) cells: Option<f64>,
    /// Compute each case at so many places on the grid, and print the worst, the mean and the standard deviation. The
    /// first is as the case is drawn; the others are moved within a cell, mirrored, turned, at spacings up to 10 %
    /// apart. Of all cases, long ones get a quarter.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = value_parser!(u16).range(1..))]
    pub(crate) places: u16,
    /// Which places these are.
    #[arg(long, value_name = "S", default_value_t = 1, allow_negative_numbers = true)]
    pub(crate) seed: u64,
    /// Print Markdown.
    #[arg(long)]
    pub(crate) markdown: bool,
    /// Threads to compute with [default: one per core]. The numbers do not depend on it.
    #[arg(long, value_name = "N", value_parser = value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
}

/// Arguments of `converge`.
#[derive(Debug, Args)]
pub(crate) struct ConvergeArguments {
    #[command(flatten)]
    pub(crate) scene: SceneArguments,
    /// How many times smaller cells are from run to run, 1.2 to 4.
    #[arg(long, value_name = "R", default_value_t = 2.0, value_parser = parse_ratio)]
    pub(crate) ratio: f64,
    /// Write the table as comma-separated values too.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) csv: Option<PathBuf>,
    /// Draw what converges over the size of cells, as SVG.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) svg: Option<PathBuf>,
    /// Threads to compute with [default: one per core]. The numbers do not depend on it.
    #[arg(long, value_name = "N", value_parser = value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
}

/// Arguments of `chart`.
#[derive(Debug, Args)]
pub(crate) struct ChartArguments {
    /// The chart [default: all].
    #[arg(value_enum)]
    pub(crate) name: Option<ChartName>,
    /// Few and coarse runs, which show the shape.
    #[arg(long)]
    pub(crate) quick: bool,
    /// Folder with the examples, for the charts of them.
    #[arg(long, value_name = "DIR", default_value = "examples", value_hint = ValueHint::DirPath)]
    pub(crate) examples: PathBuf,
    /// Folder to write into; made when missing.
    #[arg(long, value_name = "DIR", default_value = "docs/charts", value_hint = ValueHint::DirPath)]
    pub(crate) output: PathBuf,
    /// Threads to compute with [default: one per core].
    #[arg(long, value_name = "N", value_parser = value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
}

/// A chart.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ChartName {
    /// Errors against time, for each way to solve.
    Accuracy,
    /// Where the method fails: maps of two parameters.
    Stability,
    /// Speed and memory over the number of particles, with and without cracks.
    Speed,
    /// Where the time of each example goes.
    Stages,
    /// An example at four resolutions.
    Visual,
    /// The figures of the thesis that this comes from, again.
    Thesis,
    /// Cost of single features where nothing needs them.
    Features,
    /// Errors and times said before a run beside those that come out.
    Dial,
}

impl ChartName {
    /// All, in the order in which they are made.
    pub(crate) const ALL: [Self; 8] = [
        Self::Speed,
        Self::Stages,
        Self::Features,
        Self::Visual,
        Self::Thesis,
        Self::Stability,
        Self::Dial,
        Self::Accuracy,
    ];
}

/// How to speak.
#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct TalkArguments {
    /// Form of progress and messages on standard error: `text`, or `json`, one object per line.
    #[arg(long, global = true, value_enum, hide_possible_values = true, default_value_t = LogFormat::Text, value_name = "FORM")]
    pub(crate) log: LogFormat,
    /// No progress; only errors.
    #[arg(long, global = true)]
    pub(crate) quiet: bool,
}

/// Form of messages.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum LogFormat {
    /// For people.
    Text,
    /// For programs.
    Json,
}

/// Reads one of `words` as the scene file would: what it stands for is said there, once. Shells complete them.
fn words<T>(words: &'static [&'static str]) -> impl TypedValueParser<Value = T>
where
    T: serde::de::DeserializeOwned + Clone + Send + Sync + 'static,
{
    let meant = |word: String| serde_json::from_value::<T>(serde_json::Value::String(word));
    PossibleValuesParser::new(words).try_map(meant)
}

/// Why a number of the command line is refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
enum NumberError {
    #[error("not a number")]
    Unreadable,
    #[error("it must be above 0 and finite [m]")]
    NotPositive,
    #[error("the cells must be 4 to 1024")]
    CellsOutOfRange,
    #[error("the view can be turned by -80 to 80 degrees")]
    TurnOutOfRange,
    #[error("the ratio must be 1.2 to 4")]
    RatioOutOfRange,
}

fn parse_length(word: &str) -> Result<f64, NumberError> {
    let value: f64 = word.parse().map_err(|_| NumberError::Unreadable)?;
    if value.is_finite() && value > 0.0 { Ok(value) } else { Err(NumberError::NotPositive) }
}

fn parse_cells(word: &str) -> Result<f64, NumberError> {
    let value: f64 = word.parse().map_err(|_| NumberError::Unreadable)?;
    if (4.0..=1024.0).contains(&value) { Ok(value) } else { Err(NumberError::CellsOutOfRange) }
}

/// Beyond these, all that is drawn would be a line or the back.
fn parse_turn(word: &str) -> Result<f64, NumberError> {
    let value: f64 = word.parse().map_err(|_| NumberError::Unreadable)?;
    if (-80.0..=80.0).contains(&value) { Ok(value) } else { Err(NumberError::TurnOutOfRange) }
}

fn parse_ratio(word: &str) -> Result<f64, NumberError> {
    let value: f64 = word.parse().map_err(|_| NumberError::Unreadable)?;
    if (1.2..=4.0).contains(&value) { Ok(value) } else { Err(NumberError::RatioOutOfRange) }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn definitions_are_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn every_word_of_the_command_line_is_one_of_the_scene_file() {
        let mut program = Arguments::command();
        program.build();
        let run = program.find_subcommand("run").unwrap();
        for option in ["formats", "parts", "up", "cut"] {
            let words = run.get_arguments().find(|argument| argument.get_id() == option).unwrap().get_possible_values();
            let words: Vec<_> = words.iter().map(|word| word.get_name().to_owned()).collect();
            let schema = fissure_scene::schema();
            let of_schema = &schema["$defs"][match option {
                "formats" => "Format",
                "parts" => "Part",
                "cut" => "Cut",
                _ => "UpAxis",
            }];
            let known = of_schema["oneOf"].as_array().unwrap().iter().map(|word| word["const"].as_str().unwrap());
            assert!(known.eq(words.iter()), "{option}: {words:?}, {of_schema}");
            for word in words {
                Arguments::try_parse_from(["fissure", "run", "s.toml", &format!("--{option}={word}")]).unwrap();
            }
        }
    }

    #[test]
    fn words_of_the_scene_file_are_the_words_of_the_command_line() {
        let typed = ["fissure", "run", "s.toml", "--formats", "glb,ply", "--parts", "cracked,faces", "--up", "y"];
        let Command::Run(run) = Arguments::try_parse_from(typed).unwrap().command else { unreachable!() };
        assert_eq!(run.mesh.formats, [Format::Glb, Format::Ply]);
        assert_eq!(run.mesh.parts, [Part::Cracked, Part::Faces]);
        assert_eq!(run.mesh.up, Some(UpAxis::Y));
    }

    #[test]
    fn a_thickness_that_is_no_length_is_refused() {
        for bad in ["0", "-1", "nan", "inf", "thick"] {
            assert!(
                Arguments::try_parse_from(["fissure", "post", "a.take", &format!("--thickness={bad}")]).is_err(),
                "{bad}"
            );
        }
    }
}
