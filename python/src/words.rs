//! Hints in the words of Python: those of Plume name options and commands of the command line.

/// What to say instead; longer phrases come before those that they contain.
const WORDS: [(&str, &str); 14] = [
    ("`plume generate CAVE_DIR --force`", "`plume.generate(CAVE_DIR, force=True)`"),
    ("`plume generate -o`", "`plume.generate(folder=...)`"),
    ("`plume chunk -o`", "`plume.make_chunks`"),
    ("`plume new` prints", "`print(plume.Recipe().to_toml())` shows"),
    ("`plume graph` exports", "`cave.graph.to_dict()` has"),
    ("`--kind tour`", "`kind=\"tour\"`"),
    ("; at an import `--parts join`", ""),
    ("`--set graph.parts=join`", "`{\"graph.parts\": \"join\"}`"),
    ("`--set texture.format=png`", "`{\"texture.format\": \"png\"}`"),
    ("`--force`", "`force=True`"),
    ("--force", "`force=True`"),
    ("--allow-run", "`allow_run=True`"),
    ("--allow-outside", "`allow_outside=True`"),
    ("run the same command again", "make the same call again"),
];

/// The hint as Python says it.
pub fn in_python(hint: &str) -> String {
    WORDS.iter().fold(hint.to_owned(), |hint, (command_line, python)| hint.replace(command_line, python))
}
