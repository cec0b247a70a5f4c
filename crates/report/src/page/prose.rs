//! Prose of pages: paragraphs, lists, headings and code, in a small part of Markdown.

use geobench_export::escape::xml as escape;

/// `text` as HTML. Blocks are separated by blank lines: `### ` starts a heading, `- ` an item of a
/// list, and a line of three backticks starts and ends code. `**strong**`, `` `code` `` and
/// `[text](address)` are marked up within them.
pub(super) fn html(text: &str) -> String {
    let mut html = String::new();
    let mut lines = text.lines().peekable();
    while let Some(line) = lines.next() {
        if line.starts_with("```") {
            // Escaping makes one line of a text.
            let code = lines.by_ref().take_while(|l| !l.starts_with("```"));
            let code: Vec<String> = code.map(escape).collect();
            html += &format!(
                "<pre tabindex=\"0\"><code>{}</code></pre>\n",
                code.join("\n")
            );
        } else if let Some(heading) = line.strip_prefix("### ") {
            html += &format!("<h3>{}</h3>\n", inline(heading));
        } else if let Some(first) = line.strip_prefix("- ") {
            let mut items = vec![first.to_owned()];
            while let Some(next) = lines.next_if(|l| l.starts_with("- ") || l.starts_with("  ")) {
                match (next.strip_prefix("- "), items.last_mut()) {
                    (None, Some(last)) => *last += &format!(" {}", next.trim()),
                    (item, _) => items.push(item.unwrap_or_default().to_owned()),
                }
            }
            let items = items
                .iter()
                .map(|item| format!("<li>{}</li>\n", inline(item)));
            html += &format!("<ul class=\"prose\">\n{}</ul>\n", items.collect::<String>());
        } else if !line.is_empty() {
            let mut paragraph = line.to_owned();
            while let Some(next) = lines.next_if(|l| !l.is_empty() && !l.starts_with("```")) {
                paragraph += &format!(" {next}");
            }
            html += &format!("<p>{}</p>\n", inline(&paragraph));
        }
    }
    html
}

/// A line with code, strong text and links marked up.
fn inline(text: &str) -> String {
    let mut html = String::new();
    let mut rest = text;
    while let Some(at) = rest.find(['`', '[', '*']) {
        html += &escape(&rest[..at]);
        let found = &rest[at..];
        let marked = match found.as_bytes()[0] {
            b'`' => found[1..]
                .split_once('`')
                .map(|(code, after)| (format!("<code>{}</code>", escape(code)), after)),
            b'[' => link(&found[1..]),
            _ => found.strip_prefix("**").and_then(|inside| {
                let (strong, after) = inside.split_once("**")?;
                Some((format!("<b>{}</b>", escape(strong)), after))
            }),
        };
        let (piece, after) = marked.unwrap_or_else(|| (escape(&found[..1]), &found[1..]));
        html += &piece;
        rest = after;
    }
    html + &escape(rest)
}

/// The link at the start of `text`, behind its bracket, and what follows it. Only links within the
/// site and to `https:` addresses are made.
fn link(text: &str) -> Option<(String, &str)> {
    let (name, rest) = text.split_once("](")?;
    let (address, after) = rest.split_once(')')?;
    let is_local = !address.contains([':', '"']) && !address.starts_with('/');
    (is_local || address.starts_with("https://")).then(|| {
        let name = inline(name);
        (format!("<a href=\"{}\">{name}</a>", escape(address)), after)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_and_marks_become_html() {
        let text = "One `a<b>`\nline, **strong** and [a *page*](method.html).\n\n- x\n  y\n- z\n\n```sh\ngeobench <x>\n  y\n```\n### Head";
        assert_eq!(
            html(text),
            "<p>One <code>a&lt;b&gt;</code> line, <b>strong</b> and <a href=\"method.html\">a *page*</a>.</p>\n\
             <ul class=\"prose\">\n<li>x y</li>\n<li>z</li>\n</ul>\n\
             <pre tabindex=\"0\"><code>geobench &lt;x&gt;\n  y</code></pre>\n<h3>Head</h3>\n"
        );
    }

    #[test]
    fn other_addresses_are_no_links() {
        assert_eq!(
            html("[x](javascript:alert(1)) 3 * 4 `open"),
            "<p>[x](javascript:alert(1)) 3 * 4 `open</p>\n"
        );
    }
}
