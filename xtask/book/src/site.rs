//! Pages of the site around book and viewer: an index, and a gallery of every scene and technique.

use std::path::Path;

use antumbra::TechniqueKind;
use antumbra_scene::builtin::{self, BuiltinInfo};
use antumbra_testing::book::root;

use crate::animation;

/// Technique of a scene's images: the library's default, or one that supports alpha-tested and translucent casters.
fn technique_of(scene: &BuiltinInfo) -> TechniqueKind {
    if scene.opaque { TechniqueKind::Smrt } else { TechniqueKind::MultiLayer }
}

/// Icon: an annular eclipse, as on the laboratory's reports.
const ICON: &str = "data:image/svg+xml,%3Csvg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 32 32'%3E\
    %3Ccircle cx='16' cy='16' r='14' fill='%23f0b35c'/%3E%3Ccircle cx='17' cy='15.4' r='10.6' fill='%231c1e22'/%3E%3C/svg%3E";

/// Files of the site that are copied unchanged. Style and copy buttons are those of the laboratory's reports.
const FILES: [(&str, &str); 3] = [
    ("report.css", "crates/antumbra-lab/src/report/style.css"),
    ("site.css", "xtask/book/site/site.css"),
    ("copy.js", "crates/antumbra-lab/src/report/copy.js"),
];

/// Writes index and gallery into a folder, and input files of the gallery's render commands into the folder `work`. Returns these
/// commands, which run in `work`, as lines `OUTPUT: COMMAND`.
///
/// # Errors
/// If a file cannot be read or written.
pub fn write(folder: &Path, work: &Path, repository: Option<&str>) -> Result<String, String> {
    let pages = [("index.html", index(repository)), ("gallery.html", gallery())];
    for (name, text) in pages {
        std::fs::write(folder.join(name), text).map_err(|error| format!("{name}: {error}"))?;
    }
    for (name, from) in FILES {
        std::fs::copy(root().join(from), folder.join(name)).map_err(|error| format!("{from}: {error}"))?;
    }
    animation::SCENES.iter().try_for_each(|scene| animation::write_setups(scene, work))?;
    let stills = builtin::NAMES.iter().map(|scene| format!("{}.png: {}", scene.name, command_of_scene(scene)));
    let animated = builtin::NAMES.iter().filter(|scene| animation::SCENES.contains(&scene.name));
    let moving = animated.flat_map(|scene| animation::commands(scene.name, technique_of(scene).name()));
    Ok(stills.chain(moving).map(|line| line + "\n").collect())
}

fn index(repository: Option<&str>) -> String {
    let link = |url| format!("<li><a href=\"{}\">Repository</a> Source, benchmarks, changelog.</li>", escape(url));
    fill(
        include_str!("../site/index.html"),
        &[
            ("icon", ICON),
            ("masthead", &masthead(repository)),
            ("techniques", &TechniqueKind::ALL.len().to_string()),
            ("scenes", &builtin::NAMES.len().to_string()),
            ("repository", &repository.map(link).unwrap_or_default()),
            ("try", &copyable("cargo xtask demo\ncargo xtask test")),
        ],
    )
}

fn gallery() -> String {
    fill(
        include_str!("../site/gallery.html"),
        &[
            ("icon", ICON),
            ("masthead", &masthead(None)),
            ("scene_cards", &builtin::NAMES.iter().map(scene_card).collect::<String>()),
            ("technique_cards", &TechniqueKind::ALL.iter().map(|kind| technique_card(*kind)).collect::<String>()),
        ],
    )
}

fn masthead(repository: Option<&str>) -> String {
    let link = |url| format!("<a href=\"{}\">Repository</a>", escape(url));
    format!(
        "<header class=\"masthead\"><div class=\"brand\"><a href=\"index.html\"><img src=\"{ICON}\" alt=\"\" width=\"22\" height=\"22\"> \
         Antumbra</a></div><nav aria-label=\"Site\"><a href=\"viewer/index.html\">Viewer</a><a href=\"gallery.html\">Gallery</a>\
         <a href=\"book/index.html\">Book</a>{}</nav></header>",
        repository.map(link).unwrap_or_default()
    )
}

/// Returns the command that renders the image of a scene.
fn command_of_scene(scene: &BuiltinInfo) -> String {
    format!(
        "antumbra render builtin:{} --technique {} --size 480x270 -o {0}.png",
        scene.name,
        technique_of(scene).name()
    )
}

/// Returns the address at which the viewer opens a scene with a technique.
fn viewer(scene: &str, kind: TechniqueKind) -> String {
    format!("viewer/index.html?scene={scene}&amp;technique={}", kind.name())
}

fn scene_card(scene: &BuiltinInfo) -> String {
    let name = scene.name;
    let still = format!("images/{name}.png");
    let others = TechniqueKind::ALL.iter().map(|kind| format!("<a href=\"{}\">{kind}</a>", viewer(name, *kind)));
    let others = format!(
        "<details><summary>Open with another technique</summary><div class=\"others\">{}</div></details>",
        others.collect::<String>()
    );
    let animation = animation::SCENES.contains(&name).then(|| format!("images/{}", animation::image(name)));
    let made_by = if animation.is_some() {
        "<p>The animation has twelve images with different setup files, made by <code>cargo xtask site</code>.</p>"
    } else {
        ""
    };
    card(&Card {
        id: &format!("scene-{name}"),
        title: name,
        image: &still,
        animation: animation.as_deref(),
        alt: &format!("{name} with soft shadows"),
        text: &format!("<p>{}</p>{made_by}", inline(scene.summary)),
        command: &command_of_scene(scene),
        viewer: &viewer(name, technique_of(scene)),
        others: &others,
    })
}

fn technique_card(kind: TechniqueKind) -> String {
    let facts = kind.facts();
    let (name, scene) = (facts.name, facts.worst_scene);
    let text = format!(
        "<p>{}: {}</p><p>Good for: {}.</p><p>Fails here: {}. <a href=\"book/limits.html#{name}-on-builtin{scene}\">Truth and \
         error</a></p>",
        inline(facts.title),
        inline(facts.source),
        inline(facts.good_for),
        inline(facts.worst_case)
    );
    card(&Card {
        id: &format!("technique-{name}"),
        title: name,
        image: &format!("book/figures/{name}.png"),
        animation: None,
        alt: &format!("{scene} with shadows by {name}"),
        text: &text,
        command: &format!("antumbra compare builtin:{scene} --techniques {name} --size 480x270 -o {name}"),
        viewer: &viewer(scene, kind),
        others: "",
    })
}

struct Card<'a> {
    id: &'a str,
    title: &'a str,
    image: &'a str,
    animation: Option<&'a str>,
    alt: &'a str,
    text: &'a str,
    command: &'a str,
    viewer: &'a str,
    others: &'a str,
}

fn card(card: &Card<'_>) -> String {
    let Card { id, title, image, alt, text, command, viewer, others, .. } = card;
    let (source, shown) = match card.animation {
        None => (String::new(), *image),
        Some(moving) => (format!("<source media=\"(prefers-reduced-motion: reduce)\" srcset=\"{image}\">"), moving),
    };
    format!(
        "<article class=\"card\" id=\"{id}\"><a href=\"{viewer}\" tabindex=\"-1\"><picture>{source}<img src=\"{shown}\" \
         alt=\"{alt}\" width=\"480\" height=\"270\" loading=\"lazy\"></picture></a><h3>{title}</h3>{text}{}<p><a href=\"{viewer}\">Open in \
         the viewer</a></p>{others}</article>\n",
        copyable(command)
    )
}

/// Returns commands, one per line, whose lines wrap between words and not at hyphens.
fn copyable(commands: &str) -> String {
    let whole = |word| format!("<span>{}</span>", escape(word));
    let lines = commands.lines().map(|line| line.split(' ').map(whole).collect::<Vec<_>>().join(" "));
    format!(
        "<div class=\"copy\"><pre><code>{}</code></pre><button type=\"button\" class=\"only-js\">Copy</button></div>",
        lines.collect::<Vec<_>>().join("\n")
    )
}

/// Returns text of a declaration as HTML; text between backticks becomes code.
fn inline(text: &str) -> String {
    let parts = escape(text);
    let parts = parts.split('`').enumerate();
    parts.map(|(i, part)| if i % 2 == 0 { part.to_owned() } else { format!("<code>{part}</code>") }).collect()
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// Replaces the `{{names}}` of a template by values.
fn fill(template: &str, values: &[(&str, &str)]) -> String {
    values.iter().fold(template.to_owned(), |text, (name, value)| text.replace(&format!("{{{{{name}}}}}"), value))
}
