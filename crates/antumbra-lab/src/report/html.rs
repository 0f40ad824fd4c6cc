//! HTML generation: escaping, templates, number formats, images as data URIs.

use std::fmt::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

/// Escapes text for the content of an element or a quoted attribute.
pub(super) fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            c => escaped.push(c),
        }
    }
    escaped
}

/// Escapes JSON for a `<script>` element, which ends at the first `</script` even within quotes.
pub(super) fn json_for_script(value: &serde_json::Value) -> String {
    value.to_string().replace('<', "\\u003c")
}

/// Replaces the `{{names}}` of a template by values, in one pass: values are not expanded again.
///
/// # Panics
/// If a name has no value: templates and values are both ours.
pub(super) fn fill(template: &str, values: &[(&str, &str)]) -> String {
    let mut filled = String::with_capacity(template.len());
    let mut rest = template;
    while let Some((before, after)) = rest.split_once("{{") {
        let (name, after) = after.split_once("}}").expect("a placeholder ends in }}");
        let (_, value) = values.iter().find(|(key, _)| *key == name).unwrap_or_else(|| panic!("no value for {name}"));
        filled.push_str(before);
        filled.push_str(value);
        rest = after;
    }
    filled + rest
}

/// Formats `1234567` as `1 234 567`, with narrow no-break spaces.
pub(super) fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

/// Formats a count to three figures: `950`, `23.5 k`, `236 M`, `1.2 G`.
pub(super) fn rounded_count(count: f64) -> String {
    match count {
        c if c < 1e3 => format!("{c:.0}"),
        c if c < 1e6 => format!("{}\u{202f}k", three_figures(c / 1e3)),
        c if c < 1e9 => format!("{}\u{202f}M", three_figures(c / 1e6)),
        c => format!("{}\u{202f}G", three_figures(c / 1e9)),
    }
}

/// Formats three significant figures without exponent: `0.0123`, `1.23`, `123`.
pub(super) fn three_figures(v: f64) -> String {
    if v == 0.0 || !v.is_finite() {
        return format!("{v}");
    }
    let decimals = (2 - v.abs().log10().floor() as i32).clamp(0, 6) as usize;
    format!("{v:.decimals$}")
}

/// Formats a number of bytes in B, KiB or MiB.
pub(super) fn bytes(count: u64) -> String {
    const KIB: f64 = 1024.0;
    match count as f64 {
        b if b < KIB => format!("{b} B"),
        b if b < KIB * KIB => format!("{} KiB", three_figures(b / KIB)),
        b => format!("{} MiB", three_figures(b / (KIB * KIB))),
    }
}

/// Formats a colour as `#rrggbb`.
pub(super) fn css_color([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Returns a PNG file as a data URI, whose pixels a script may read even if the page was opened from disk.
pub(super) fn png_data_uri(png: &[u8]) -> String {
    format!("data:image/png;base64,{}", STANDARD.encode(png))
}

/// Returns lines as a `<ul>` of a class; empty if there are none.
pub(super) fn list(class: &str, lines: &[String]) -> String {
    if lines.is_empty() {
        return String::new();
    }
    let mut html = format!("<ul class=\"{class}\">");
    for line in lines {
        let _ = write!(html, "<li>{}</li>", escape(line));
    }
    html + "</ul>"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markup_in_text_stays_text() {
        assert_eq!(escape("<a href=\"x\">'&'</a>"), "&lt;a href=&quot;x&quot;&gt;&#39;&amp;&#39;&lt;/a&gt;");
        let json = json_for_script(&serde_json::json!({ "name": "</script><b>" }));
        assert_eq!(json, r#"{"name":"\u003c/script>\u003cb>"}"#);
    }

    #[test]
    fn values_are_not_templates() {
        assert_eq!(fill("{{a}}-{{b}}", &[("a", "{{b}}"), ("b", "2")]), "{{b}}-2");
    }

    #[test]
    fn data_uris_are_in_the_standard_alphabet_with_padding() {
        // RFC 4648, section 10.
        let vectors =
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foob", "Zm9vYg=="), ("fooba", "Zm9vYmE=")];
        for (plain, coded) in vectors {
            assert_eq!(png_data_uri(plain.as_bytes()), format!("data:image/png;base64,{coded}"));
        }
        assert_eq!(png_data_uri(&[0xfb, 0xff]), "data:image/png;base64,+/8=");
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!(grouped(1_234_567), "1\u{202f}234\u{202f}567");
        assert_eq!(grouped(12), "12");
        assert_eq!([0.01234, 1.0, 123.4, 0.0, 98765.0].map(three_figures), ["0.0123", "1.00", "123", "0", "98765"]);
        assert_eq!(bytes(4 << 20), "4.00 MiB");
        assert_eq!(rounded_count(235_929_600.0), "236\u{202f}M");
    }
}
