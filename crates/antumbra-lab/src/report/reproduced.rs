//! Pages of the papers' tables and figures: one per paper, and an index.

use std::fmt::Write;
use std::path::Path;

use super::html::{escape, grouped, three_figures};
use super::page::{ICON, STYLE, software_notice};
use super::reproduced_plots::plots;
use crate::adapter_info::AdapterInfo;
use crate::output_files::{FileError, write_atomically};
use crate::reproduce::{
    ExhibitResult, Form, Judged, Measure, Measured, Outcome, Paper, RowResult, Ruling, SCENES_HINT, SCENES_VARIABLE,
    Verdict, VerdictCount,
};

/// Origin of a reproduction.
#[derive(Clone, Debug)]
pub struct ReproductionInfo {
    /// Adapter on which it was measured.
    pub adapter: AdapterInfo,
    /// Memory bandwidth of the adapter, GB/s; `None` if not given.
    pub bandwidth_gb_s: Option<f64>,
    /// Commit of Antumbra.
    pub commit: String,
    /// Date and time, as [`utc_now`](super::utc_now) writes it.
    pub date: String,
    /// Arguments that follow an exhibit's name in the command that reproduces it.
    pub arguments: String,
}

type Results<'a> = [(&'static Paper, Vec<ExhibitResult>)];

/// Writes `index.html`, a page per paper and `verdicts.md` into `dir`, which contains the images.
pub fn write_reproduction(dir: &Path, results: &Results<'_>, info: &ReproductionInfo) -> Result<(), FileError> {
    for (paper, exhibits) in results {
        let path = dir.join(format!("{}.html", paper.id));
        write_atomically(&path, paper_page(paper, exhibits, info).as_bytes())?;
    }
    write_atomically(&dir.join("verdicts.md"), verdicts_markdown(results, info).as_bytes())?;
    write_atomically(&dir.join("index.html"), index_page(results, info).as_bytes())
}

fn head(title: &str, info: &ReproductionInfo) -> String {
    let title = escape(title);
    let mut html = format!(
        "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" \
         content=\"width=device-width, initial-scale=1\"><meta name=\"color-scheme\" content=\"light \
         dark\"><title>{title} · Antumbra</title><link rel=\"icon\" \
         href=\"{ICON}\"><style>{STYLE}</style></head><body><header class=\"masthead\"><div class=\"brand\"><img \
         src=\"{ICON}\" alt=\"\" width=\"22\" height=\"22\"> <a \
         href=\"index.html\">Antumbra</a></div></header><main><div class=\"opening\"><h1>{title}</h1>"
    );
    html += "</div>";
    if info.adapter.is_software {
        html += &software_notice(&info.adapter.name);
    }
    html
}

fn foot(info: &ReproductionInfo) -> String {
    format!(
        "</main><footer>Antumbra {} · {} · {} ({}) · The numbers are in <code>reproduced.json</code> next to this \
         page.</footer></body></html>",
        escape(&info.commit),
        escape(&info.date),
        escape(&info.adapter.name),
        escape(&info.adapter.driver)
    )
}

fn index_page(results: &Results<'_>, info: &ReproductionInfo) -> String {
    let mut html = head("The papers, compared with this library", info);
    let _ = write!(
        html,
        "<p class=\"note\">The tables and figures of each paper beside ours, and for each of its claims a verdict by the \
         stated rule, for the technique as published and for this library's own form. Scene files are read from the folder in \
         {SCENES_VARIABLE}: {}.</p><ul>",
        escape(SCENES_HINT)
    );
    for (paper, exhibits) in results {
        let _ = write!(
            html,
            "<li><a href=\"{}.html\">{}</a><br>{}.</li>",
            paper.id,
            escape(paper.citation),
            counts(exhibits)
        );
    }
    html += "</ul><h2>Verdicts</h2><div class=\"scroll\"><table class=\"numbers \
             verdicts\"><thead><tr><th>Exhibit</th><th>The paper says</th><th>As published</th><th>Ours</th></tr></thead><tbody>";
    for exhibit in results.iter().flat_map(|(_, exhibits)| exhibits) {
        for judged in &exhibit.judged {
            let _ = write!(
                html,
                "<tr><th scope=\"row\"><a href=\"{}.html#{}\">{}</a></th><td>{}</td><td>{}</td><td>{}</td></tr>",
                exhibit.paper.id,
                exhibit.exhibit.id,
                escape(&exhibit.name),
                escape(judged.claim.says),
                badge(&judged.published.verdict),
                judged.ours.as_ref().map_or_else(|| "–".to_owned(), |ours| badge(&ours.verdict))
            );
        }
    }
    html += "</tbody></table></div>";
    html + &foot(info)
}

/// Returns `As published 3 claims hold, …; ours …`.
fn counts(exhibits: &[ExhibitResult]) -> String {
    let [published, ours] = [Form::Published, Form::Ours].map(|form| VerdictCount::of(exhibits, form));
    format!("As published {published}; ours {ours}")
}

fn badge(verdict: &Verdict) -> String {
    let class = match verdict {
        Verdict::Holds => "best",
        Verdict::Contradicted => "worst",
        Verdict::Undecided(_) => "open",
    };
    format!("<b class=\"{class}\">{}</b>", verdict.name())
}

fn paper_page(paper: &Paper, exhibits: &[ExhibitResult], info: &ReproductionInfo) -> String {
    let mut html = head(paper.id, info);
    let _ = write!(
        html,
        "<p class=\"lede\">{}</p><p class=\"note\">{}.</p><p class=\"note\">{}</p><p class=\"note\">The paper's images are not \
         reproduced here; ours are shown beside their references.</p>",
        escape(paper.citation),
        counts(exhibits),
        escape(&bandwidths(paper, info))
    );
    for exhibit in exhibits {
        html += &section(exhibit, info);
    }
    html + &foot(info)
}

/// Explains how to compare times.
fn bandwidths(paper: &Paper, info: &ReproductionInfo) -> String {
    let there = format!(
        "The paper's times were measured on an {} with {} GB/s. Its frames per second are of whole frames, ours of the shadows \
         only unless stated otherwise.",
        paper.hardware, paper.bandwidth_gb_s
    );
    match info.bandwidth_gb_s {
        Some(here) => format!("{there} {} has {here} GB/s.", info.adapter.name),
        None => format!("{there} Give this adapter's bandwidth with --bandwidth to see ratios at equal bandwidth."),
    }
}

fn section(result: &ExhibitResult, info: &ReproductionInfo) -> String {
    let exhibit = result.exhibit;
    let mut html = format!(
        "<section aria-labelledby=\"{id}\"><h2 id=\"{id}\">{id}</h2><p class=\"note\">{}</p>",
        escape(exhibit.shows),
        id = exhibit.id
    );
    if !exhibit.note.is_empty() {
        let _ = write!(html, "<p class=\"note\">Not covered: {}</p>", escape(exhibit.note));
    } else if exhibit.rows.is_empty() {
        html += "<p class=\"note\">A drawing, so there is nothing to run.</p>";
    }
    if exhibit.rows.is_empty() {
        return html + "</section>";
    }
    html += &claims(&result.judged);
    html += &table(result, info);
    html += &plots(result);
    html += &pictures(&result.rows);
    let _ = write!(
        html,
        "<div class=\"copy\"><pre><code>antumbra reproduce {}{}</code></pre></div></section>",
        escape(&result.name),
        escape(&info.arguments)
    );
    html
}

fn claims(judged: &[Judged]) -> String {
    let mut html = String::new();
    for one in judged {
        let _ =
            write!(html, "<div class=\"claim\"><p>The paper: {}{}</p>", escape(one.claim.says), escape(&at_size(one)));
        for (form, ruling) in one.rulings() {
            let found: String = ruling.found.iter().map(|line| format!("<li>{}</li>", escape(line))).collect();
            let _ = write!(
                html,
                "<p>{} {}: {}</p><ul class=\"notes\">{found}</ul>",
                badge(&ruling.verdict),
                capitalised(form),
                escape(&ruling.sentence())
            );
        }
        html += "</div>";
    }
    html
}

fn capitalised(form: Form) -> &'static str {
    match form {
        Form::Published => "As published",
        Form::Ours => "Ours",
    }
}

/// Returns ` (at 256 × 144)`; empty without sizes.
fn at_size(judged: &Judged) -> String {
    if judged.sizes.is_empty() { String::new() } else { format!(" (at {})", judged.sizes) }
}

fn table(result: &ExhibitResult, info: &ReproductionInfo) -> String {
    let mut html =
        "<div class=\"scroll\"><table class=\"numbers\"><thead><tr><th>Row</th><th>Technique</th><th>Scene</th>\
                    <th>Picture</th><th>Paper</th><th>Here</th><th>Times the paper's time</th></tr></thead><tbody>"
            .to_owned();
    for RowResult { row, form, outcome, .. } in &result.rows {
        let settings: Vec<String> = row.settings_of(*form).map(|(key, value)| format!("{key}={value}")).collect();
        let technique = if row.technique.is_empty() { "–" } else { row.technique };
        let of_form =
            if row.forms(result.paper).len() > 1 { format!("<br><small>{form}</small>") } else { String::new() };
        let _ = write!(
            html,
            "<tr><th scope=\"row\">{}</th><td title=\"{}\">{}{of_form}</td>",
            escape(row.what),
            escape(&settings.join(" ")),
            escape(technique)
        );
        let view = row.view.map(|view| format!("<br><small>views/{}.toml</small>", escape(view))).unwrap_or_default();
        let scene = escape(row.scene);
        match outcome {
            Outcome::Measured(measured) => {
                let [width, height] = measured.size_px;
                let _ = write!(
                    html,
                    "<td>{scene}{view}<br><small>{} triangles</small></td><td>{width} × \
                     {height}{}</td><td>{}</td><td>{}</td><td>{}</td></tr>",
                    grouped(measured.triangles),
                    full_size(row.size_px, measured.size_px),
                    escape(&row.measure.paper_text()),
                    here(measured, row),
                    ratio(result.paper, row, measured, info)
                );
            }
            other => {
                let (paper, why) = (escape(&row.measure.paper_text()), escape(&other.to_string()));
                let _ =
                    write!(html, "<td>{scene}{view}</td><td></td><td>{paper}</td><td colspan=\"2\">{why}</td></tr>");
            }
        }
    }
    html + "</tbody></table></div>"
}

/// Returns the full size of a row if it is drawn smaller here.
fn full_size((width, height): (u32, u32), here: [u32; 2]) -> String {
    if [width, height] == here { String::new() } else { format!("<br><small>on a GPU: {width} × {height}</small>") }
}

fn here(measured: &Measured, row: &crate::reproduce::Row) -> String {
    let mut html = escape(&measured.text(&row.measure));
    if let Some(flat) = measured.flat_rmse {
        let _ = write!(html, "<br><small>a flat mask: rmse {flat:.4}</small>");
    }
    html
}

/// Returns the ratio of our time to the paper's, and the same at equal memory bandwidth.
fn ratio(paper: &Paper, row: &crate::reproduce::Row, measured: &Measured, info: &ReproductionInfo) -> String {
    let (Some(there), Some(here)) = (row.measure.paper_ms(), measured.ms) else { return "–".to_owned() };
    // A paper's times are of its graphics card, so times of a CPU are not comparable.
    if info.adapter.is_software || matches!(row.measure, Measure::SceneMs { .. }) {
        return "–".to_owned();
    }
    let ratio = here / there;
    let with_bandwidths = info.bandwidth_gb_s.map(|own| {
        format!("<br><small>{} at equal bandwidth</small>", three_figures(ratio * own / paper.bandwidth_gb_s))
    });
    three_figures(ratio) + &with_bandwidths.unwrap_or_default()
}

fn pictures(rows: &[RowResult]) -> String {
    let mut html = String::new();
    for RowResult { row, form, pictures, .. } in rows {
        let Some(files) = pictures else { continue };
        let shown = [
            files.reference.as_deref().map(|file| (file, "reference")),
            Some((files.picture.as_str(), "this")),
            files.error.as_deref().map(|file| (file, "error: blue is too dark, red is too bright")),
        ];
        html += "<div class=\"shots\">";
        for (file, what) in shown.into_iter().flatten() {
            let (file, text) = (escape(file), escape(&format!("{}, {form}: {what}", row.what)));
            let _ = write!(
                html,
                "<a class=\"shot\" href=\"{file}\"><img src=\"{file}\" alt=\"{text}\" \
                 loading=\"lazy\"><span>{text}</span></a>"
            );
        }
        html += "</div>";
    }
    html
}

fn verdicts_markdown(results: &Results<'_>, info: &ReproductionInfo) -> String {
    let cell = |text: &str| text.replace('|', "\\|");
    let mut text = format!(
        "On {}, at {}. Scene files are read from the folder in `{SCENES_VARIABLE}`: {SCENES_HINT}.\n\n| exhibit | the paper \
         says | size | as published | by | ours | by |\n|---|---|---|---|---|---|---|\n",
        info.adapter.name, info.commit
    );
    for exhibit in results.iter().flat_map(|(_, exhibits)| exhibits) {
        for judged in &exhibit.judged {
            let _ = writeln!(
                text,
                "| {} | {} | {} | {} | {} | {} | {} |",
                cell(&exhibit.name),
                cell(judged.claim.says),
                judged.sizes,
                cell(&judged.published.sentence()),
                cell(&judged.published.found.join("; ")),
                cell(&judged.ours.as_ref().map_or_else(|| "–".to_owned(), Ruling::sentence)),
                cell(&judged.ours.as_ref().map_or_else(String::new, |ours| ours.found.join("; ")))
            );
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reproduce::{
        Claim, Exhibit, Figure, Measure, Outcomes, PAPERS, PictureFiles, Reported, Row, Rule, Settings, judge,
    };

    const NONE: Settings = &[("key", "<value>")];
    static ROWS: [Row; 2] = [
        Row {
            what: "<b>first</b>",
            scene: "a&b.glb",
            view: None,
            technique: "pcss",
            settings: NONE,
            ours: &[],
            is_published_alone: false,
            size_px: (1280, 720),
            light_scale: 1.0,
            frames: 1,
            measure: Measure::Fps { paper: Reported::Number(100.0) },
            is_slow: false,
            is_timed_too: false,
            plotted: None,
        },
        Row {
            what: "second",
            scene: "no-such.glb",
            view: None,
            technique: "pcss",
            settings: NONE,
            ours: &[],
            is_published_alone: false,
            size_px: (64, 36),
            light_scale: 1.0,
            frames: 1,
            measure: Measure::Error,
            is_slow: false,
            is_timed_too: false,
            plotted: None,
        },
    ];
    static EXHIBIT: Exhibit = Exhibit {
        id: "figure1",
        shows: "<i>what</i>",
        rows: &ROWS,
        claims: &[Claim {
            says: "a < b | c",
            rules: &[Rule::AtMost(Figure::Ms, "<b>first</b>", 30.0)],
            on_any_adapter: false,
            because: "",
            because_ours: "",
            if_too_close: "",
            needs: "",
        }],
        note: "",
    };
    static PAPER: Paper = Paper {
        id: "nobody-1999",
        citation: "A & B",
        hardware: "card",
        bandwidth_gb_s: 100.0,
        own: &["pcss"],
        exhibits: &[],
    };

    fn page(bandwidth_gb_s: Option<f64>, is_software: bool) -> String {
        let first = Outcome::Measured(Measured { ms: Some(20.0), size_px: [64, 36], ..Measured::default() });
        let second = Outcome::Measured(Measured { ms: Some(40.0), size_px: [64, 36], ..Measured::default() });
        let outcomes = [first, Outcome::NotReady("no-such.glb".into())];
        let ours = [Some(second), None];
        let pictures = PictureFiles { picture: "images/\"x\".png".into(), reference: None, error: None };
        let rows = vec![
            RowResult {
                row: &ROWS[0],
                form: Form::Published,
                outcome: outcomes[0].clone(),
                pictures: Some(pictures),
                cut_short_s: None,
            },
            RowResult {
                row: &ROWS[1],
                form: Form::Published,
                outcome: outcomes[1].clone(),
                pictures: None,
                cut_short_s: None,
            },
        ];
        let judged = judge(&EXHIBIT, Outcomes { published: &outcomes, ours: &ours }, is_software);
        let result =
            ExhibitResult { name: "nobody-1999/figure1".into(), paper: &PAPER, exhibit: &EXHIBIT, rows, judged };
        let adapter = AdapterInfo { name: "<card>".into(), is_software, ..AdapterInfo::default() };
        let arguments = " -o 'a<b'".to_owned();
        let info =
            ReproductionInfo { adapter, bandwidth_gb_s, commit: "c0ffee".into(), date: "today".into(), arguments };
        let results = [(&PAPER, vec![result])];
        if !is_software {
            let text = verdicts_markdown(&results, &info);
            assert!(text.contains("a < b \\| c | 64 × 36 | The claim holds here."), "{text}");
            let index = index_page(&results, &info);
            for count in ["As published 1 claims hold, 0 are contradicted", "ours 0 claims hold, 1 are contradicted"] {
                assert!(index.contains(count), "{count}\n{index}");
            }
        }
        paper_page(&PAPER, &results[0].1, &info)
    }

    #[test]
    fn the_page_says_all_and_escapes_names() {
        let html = page(Some(50.0), false);
        for part in [
            "&lt;b&gt;first&lt;/b&gt;",
            "a&amp;b.glb",
            "&lt;i&gt;what&lt;/i&gt;",
            "a &lt; b | c",
            "key=&lt;value&gt;",
            "images/&quot;x&quot;.png",
            "-o &#39;a&lt;b&#39;",
            "&lt;card&gt;",
            "c0ffee",
            "64 × 36<br><small>on a GPU: 1280 × 720</small>",
            "50.00 fps of shadows only",
            "2.00<br><small>1.00 at equal bandwidth</small>",
            "As published: The claim holds here.",
            "Ours: The claim is contradicted here.",
            "(at 64 × 36)",
            "at most 30: here 20.000 ms",
            "not ready: set ANTUMBRA_SCENES to a folder that contains no-such.glb",
        ] {
            assert!(html.contains(part), "{part}\n{html}");
        }
        for raw in ["<b>first", "<i>what", "=<value", "<card>"] {
            assert!(!html.contains(raw), "{raw}");
        }
        assert!(page(None, false).contains("--bandwidth") && !page(None, false).contains("at equal bandwidth</small>"));
        // Times of a CPU are not compared with those of a graphics card.
        assert!(!page(Some(50.0), true).contains("at equal bandwidth</small>"));
    }
    /// Returns results as if each row had run: errors that differ, and times where a row has them.
    fn all_measured(paper: &'static Paper, exhibit: &'static Exhibit) -> ExhibitResult {
        let runs = exhibit.rows.iter().flat_map(|row| row.forms(paper).iter().map(move |form| (row, *form)));
        let rows = runs.enumerate().map(|(i, (row, form))| {
            let at = 1.0 + i as f64;
            let ms = (row.is_timed_too || row.measure.is_timed()).then_some(at);
            let rmse = row.measure.is_error().then_some(0.01 * at);
            let outcome = Outcome::Measured(Measured { ms, rmse, size_px: [64, 36], ..Measured::default() });
            RowResult { row, form, outcome, pictures: None, cut_short_s: None }
        });
        let name = format!("{}/{}", paper.id, exhibit.id);
        ExhibitResult { name, paper, exhibit, rows: rows.collect(), judged: Vec::new() }
    }

    /// Exhibits with rows that are timed beside their error, or that differ in a parameter, have their plots on the paper's page, with
    /// every row's name; others have none.
    #[test]
    fn pages_of_papers_with_plots_have_them() {
        let info = ReproductionInfo {
            adapter: AdapterInfo::default(),
            bandwidth_gb_s: None,
            commit: "c0ffee".into(),
            date: "today".into(),
            arguments: String::new(),
        };
        let mut plots_of_papers = Vec::new();
        for paper in &PAPERS {
            let results: Vec<ExhibitResult> =
                paper.exhibits.iter().map(|exhibit| all_measured(paper, exhibit)).collect();
            let page = paper_page(paper, &results, &info);
            let has = |is_asked: &dyn Fn(&Row) -> bool| {
                paper.exhibits.iter().filter(|exhibit| exhibit.rows.iter().any(is_asked)).count()
            };
            let asked = [has(&|row| row.is_timed_too), has(&|row| row.plotted.is_some())];
            let shown =
                ["Error against time", "Error against the varied quantity"].map(|text| page.matches(text).count());
            assert_eq!(shown, asked, "{}", paper.id);
            assert!(page.matches("<svg").count() >= asked[0] + asked[1], "{}", paper.id);
            for result in &results {
                let html = section(result, &info);
                for row in result.exhibit.rows.iter().filter_map(|row| row.plotted) {
                    assert!(html.contains(&escape(row.axis)) && html.contains(&escape(row.line)), "{}", result.name);
                }
            }
            plots_of_papers.push(asked[0] + asked[1]);
        }
        // Every paper has a plot.
        assert!(plots_of_papers.iter().all(|count| *count > 0), "{plots_of_papers:?}");
    }
}
