//! `cargo xtask demo`: from nothing to a report.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use crate::machine;
use crate::shell::{self, cargo, find};

/// The built-in scenes of the demo, and what each shows.
const SCENES: [(&str, &str); 4] = [
    ("overlap", "Three stacked occluders: what leaks through where one averaged blocker stands for many."),
    ("leaning-plank", "One occluder from contact to far: the penumbra must widen along it."),
    ("lantern-wall", "A close and a distant occluder over one wall."),
    ("bench-under-tree", "Leaves far above, boards close by: both penumbrae in one picture."),
];

/// Sets up, builds, compares, writes an index, and opens it where there is a display.
///
/// # Errors
/// The first step that failed. A scene of the user's that cannot be compared does not stop the others.
pub fn run(args: &[String]) -> Result<(), String> {
    let began = Instant::now();
    let (flags, given): (Vec<&String>, Vec<&String>) = args.iter().partition(|arg| arg.starts_with('-'));
    if let Some(unknown) = flags.iter().find(|flag| ***flag != "--open" && ***flag != "--no-open") {
        return Err(format!("demo has no option `{unknown}`; it has --open and --no-open"));
    }
    machine::set_up()?;
    eprintln!("xtask: building the command `antumbra` (about six minutes on two cores the first time)");
    shell::run(cargo().args(["build", "--locked", "--package", "antumbra-cli"]))?;
    let antumbra = built_binary()?;

    let out = crate::root().join("out/demo");
    let mut entries = Vec::new();
    let mut failed = Vec::new();
    let built_in = SCENES.iter().map(|(name, shows)| (format!("builtin:{name}"), (*name).to_owned(), *shows));
    let given = given.iter().map(|path| {
        let stem = Path::new(path.as_str()).file_stem().unwrap_or_default().to_string_lossy().into_owned();
        ((*path).clone(), stem, "Given on the command line.")
    });
    // The user's own scenes first: that is what they came for.
    for (spec, name, shows) in given.chain(built_in) {
        let dir = out.join(&name);
        let scene_began = Instant::now();
        match shell::run(
            Command::new(&antumbra).arg("compare").arg(&spec).args(["--size", "640x360"]).arg("-o").arg(&dir),
        ) {
            Ok(()) => {
                eprintln!("xtask: {spec} took {} s", scene_began.elapsed().as_secs());
                entries.push((name, spec, shows));
            }
            Err(problem) => failed.push(problem),
        }
    }
    if entries.is_empty() {
        return Err(failed.join("\n"));
    }
    let index = out.join("index.html");
    std::fs::write(&index, index_page(&out, &entries)).map_err(|e| format!("{}: {e}", index.display()))?;
    eprintln!("xtask: done after {} s", began.elapsed().as_secs());
    println!("{}", index.display());
    let wants_open = !flags.iter().any(|flag| *flag == "--no-open");
    let has_display = ["DISPLAY", "WAYLAND_DISPLAY"].iter().any(|name| std::env::var_os(name).is_some());
    if wants_open && has_display && find("xdg-open").is_some() {
        // The path is printed already; a desktop that opens nothing is no failure of the demo.
        let _ = shell::run(Command::new("xdg-open").arg(&index));
    }
    if failed.is_empty() { Ok(()) } else { Err(failed.join("\n")) }
}

/// Cargo puts every binary of the profile that runs us beside us.
fn built_binary() -> Result<PathBuf, String> {
    let own = std::env::current_exe().map_err(|error| format!("cannot tell where this program lies: {error}"))?;
    let binary = own.with_file_name(format!("antumbra{}", std::env::consts::EXE_SUFFIX));
    if binary.is_file() { Ok(binary) } else { Err(format!("expected the built command at {}", binary.display())) }
}

fn index_page(out: &Path, entries: &[(String, String, &str)]) -> String {
    let mut page = String::from(
        "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\"><meta name=\"viewport\" \
         content=\"width=device-width\"><title>Antumbra demo</title>\n<style>\n\
         body{font:16px/1.5 system-ui,sans-serif;margin:2rem auto;max-width:70rem;padding:0 1rem;\
         background:#16171a;color:#e4e4e6}\n\
         a{color:inherit;text-decoration:none}\n\
         main{display:grid;grid-template-columns:repeat(auto-fill,minmax(20rem,1fr));gap:1.5rem}\n\
         article{background:#212328;border-radius:8px;overflow:hidden}\n\
         img{width:100%;display:block;aspect-ratio:16/9;object-fit:cover;background:#000}\n\
         h2{font-size:1.1rem;margin:.7rem 1rem 0} p{margin:.2rem 1rem 1rem;color:#b5b6bb}\n\
         </style>\n<h1>Antumbra: soft shadows against ray-traced truth</h1>\n\
         <p>Each page compares every technique with the truth: pictures, error maps, numbers, milliseconds.</p>\n<main>\n",
    );
    for (name, spec, shows) in entries {
        let picture = picture_of(&out.join(name))
            .map_or_else(String::new, |file| format!("<img src=\"{}/{}\" alt=\"\">", escape(name), escape(&file)));
        let _ = writeln!(
            page,
            "<article><a href=\"{0}/index.html\">{picture}<h2>{0}</h2><p>{shows}<br><code>antumbra compare {1}</code></p></a></article>",
            escape(name),
            escape(spec)
        );
    }
    page.push_str("</main></html>\n");
    page
}

/// The report's shaded reference, or any picture it has, relative to the report.
fn picture_of(report: &Path) -> Option<String> {
    let mut pictures = Vec::new();
    for dir in ["", "images"] {
        let entries = std::fs::read_dir(report.join(dir)).into_iter().flatten().flatten();
        let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
        let prefix = if dir.is_empty() { String::new() } else { format!("{dir}/") };
        pictures.extend(names.filter(|name| name.ends_with(".png")).map(|name| format!("{prefix}{name}")));
    }
    pictures.sort();
    let preferred = |wanted: &str| pictures.iter().find(|name| name.contains("reference") && name.contains(wanted));
    preferred("shaded").or_else(|| preferred("")).or_else(|| pictures.first()).cloned()
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
