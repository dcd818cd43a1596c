//! The frame of all pages: `document.html`, filled in with `page.css` and the scripts `charts.js` and `pictures.js`.

use super::html::{escaped, script_json};
use serde_json::Value;

const TEMPLATE: &str = include_str!("document.html");
const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = concat!(include_str!("charts.js"), include_str!("pictures.js"));

/// A page without its frame.
pub struct Document<'a> {
    /// The names of its runs, as text.
    pub name: &'a str,
    /// Its title, as text.
    pub title: &'a str,
    /// The progress of the run, as HTML.
    pub status: String,
    /// The sections: the name of each in addresses, and its title.
    pub sections: &'a [(&'a str, &'a str)],
    /// The sections themselves, as HTML.
    pub main: String,
    /// What has made the run, as text.
    pub creator: &'a str,
    /// The data for the script.
    pub data: Value,
}

impl Document<'_> {
    /// The page.
    pub fn html(&self) -> String {
        let link = |(name, title): &(&str, &str)| format!("<a href=\"#{name}\">{title}</a>");
        fill(TEMPLATE, |key| match key {
            "style" => STYLE.to_owned(),
            "script" => SCRIPT.to_owned(),
            "name" => escaped(self.name),
            "title" => escaped(self.title),
            "status" => self.status.clone(),
            "sections" => self.sections.iter().map(link).collect(),
            "main" => self.main.clone(),
            "creator" => escaped(self.creator),
            "data" => script_json(&self.data),
            _ => String::new(),
        })
    }
}

/// Replaces `{{key}}` by its value. Inserted values are not scanned again.
pub fn fill(template: &str, value: impl Fn(&str) -> String) -> String {
    let mut parts = template.split("{{");
    let mut out = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (key, text) = part.split_once("}}").unwrap_or((part, ""));
        out += &value(key);
        out += text;
    }
    out
}

/// A sentence in place of a missing part.
pub fn missing(what: &str, reason: &str) -> String {
    format!("<p class=\"missing\">{what}: {}.</p>\n", escaped(reason))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_filled_in_is_not_filled_again() {
        let value = |key: &str| if key == "a" { "{{b}}".to_owned() } else { "x".to_owned() };
        assert_eq!(fill("1 {{a}} 2 {{b}}", value), "1 {{b}} 2 x");
    }

    #[test]
    fn a_page_has_its_sections_and_its_data() {
        let document = Document {
            name: "a < b",
            title: "Title",
            status: "<p>done</p>".to_owned(),
            sections: &[("curves", "Curves")],
            main: "<section id=\"curves\"></section>".to_owned(),
            creator: "",
            data: serde_json::json!({ "t": "</script>" }),
        };
        let html = document.html();
        assert!(html.contains("<title>a &lt; b &ndash; stsolve</title>") && html.contains("<p>done</p>"));
        assert!(html.contains("<a href=\"#curves\">Curves</a>") && html.contains("<section id=\"curves\">"));
        assert!(html.contains(r#"{"t":"<\/script>"}"#) && !html.contains("{{"), "{html}");
    }
}
