//! Verbs and options of earlier versions, by the command's own list of them.

/// A verb, an option of it (none: the verb itself; `SCENE`: a scene right behind it), and the present form.
pub(crate) type Retired = (String, String, String);

/// The rows of `RETIRED` in the source of the command.
pub(crate) fn rows(source: &str) -> Vec<Retired> {
    let (_, list) = source.split_once("RETIRED: &[(&str, &str, &str)] = &[").expect("the list begins");
    let (list, _) = list.split_once("];").expect("the list ends");
    list.lines().filter(|line| !line.trim().is_empty()).map(|line| row(line.trim())).collect()
}

fn row(line: &str) -> Retired {
    let cells: Option<Vec<String>> = line
        .strip_prefix('(')
        .and_then(|line| line.strip_suffix("),"))
        .and_then(|line| serde_json::from_str(&format!("[{line}]")).ok());
    let [verb, option, now] = <[String; 3]>::try_from(cells.unwrap_or_default()).expect("a row of three texts a line");
    (verb, option, now)
}

/// Retired verbs and options in the code of a page: fenced lines and text in backticks.
pub(crate) fn used(page: &str, retired: &[Retired]) -> Vec<String> {
    let (mut fenced, mut found) = (false, Vec::new());
    for line in page.lines() {
        if line.trim_start().starts_with("```") {
            fenced = !fenced;
        } else if fenced {
            found.extend(command(line, retired));
        } else {
            let spans = line.split('`').skip(1).step_by(2);
            found.extend(spans.filter_map(|span| command(span, retired).or_else(|| option(span, retired))));
        }
    }
    found
}

/// The command that a text gives, if it is retired. Without `softlimb` in front a verb counts only with words behind it.
fn command(text: &str, retired: &[Retired]) -> Option<String> {
    let text = text.split(" #").next()?.trim();
    let named = text.strip_prefix("softlimb ").or_else(|| text.split_once("-p softlimb -- ").map(|(_, rest)| rest));
    let words: Vec<&str> = named.unwrap_or(text).split_whitespace().map(|word| word.trim_matches(['[', ']'])).collect();
    let (verb, rest) = words.split_first()?;
    let has = |option: &str| match option {
        "" => named.is_some(),
        "SCENE" => rest.first().is_some_and(|word| *word == "SCENE" || word.ends_with(".toml")),
        _ => rest.iter().any(|word| word.split('=').next() == Some(option)),
    };
    let (_, _, now) = retired.iter().find(|(of, option, _)| of == verb && has(option))?;
    Some(format!("`{text}`: now `{now}`"))
}

/// An option by itself, if no present form has it.
fn option(span: &str, retired: &[Retired]) -> Option<String> {
    let word = span.split_whitespace().next()?;
    let present = |(_, _, now): &Retired| now.split_whitespace().any(|other| other == word);
    let (_, _, now) = retired.iter().find(|(_, option, _)| option == word && option.starts_with("--"))?;
    (!retired.iter().any(present)).then(|| format!("`{span}`: now `{now}`"))
}

#[test]
fn retired_commands_and_options_are_found() {
    let source = "const RETIRED: &[(&str, &str, &str)] = &[\n    (\"fem\", \"\", \"softlimb fea\"),\n    \
                  (\"fea\", \"--layer-mm\", \"--layer 0.05mm\"),\n    (\"calibrate\", \"--data\", \"calibrate pressure\"),\n    \
                  (\"design\", \"SCENE\", \"softlimb design limb SCENE\"),\n    (\"fea\", \"--s\", \"--section \\\"6 mm2\\\" --data\"),\n];\n";
    let rows = rows(source);
    assert_eq!(rows.len(), 5);
    let of = |page: &str| used(page, &rows).len();
    for page in [
        "```sh\nsoftlimb fem run a.toml   # old\n```",
        "```sh\nsoftlimb fea run SCENE [--layer-mm MM]\n```",
        "```sh\ncargo run --release -p softlimb -- design a.toml\n```",
        "see `fea export a.toml --layer-mm=0.1` first",
        "| `--layer-mm` | thickness |",
        "or `--layer-mm 0.1`",
        "`softlimb design SCENE`",
        "`calibrate --data`",
    ] {
        assert_eq!(of(page), 1, "{page}");
    }
    for page in [
        "```sh\nsoftlimb fea run a.toml --layer 0.1\n```",
        "the `fem` of others, `--data` of another verb, --layer-mm of prose",
        "`design limb a.toml`, `softlimb design limb SCENE`",
        "`cargo xtask lab design --data x.json`",
    ] {
        assert_eq!(of(page), 0, "{page}");
    }
}
