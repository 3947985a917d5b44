//! A machine file that is none: what its reader says, and where a whole one is to be seen.

/// What is wrong, its place, and where a whole file is to be seen.
pub(crate) fn syntax(error: &toml::de::Error) -> String {
    let text = error.to_string().trim_end().to_owned();
    match error.message().starts_with("invalid type") {
        true => text,
        false => {
            text + "\nhelp: a machine file is TOML; `pitchlock machine` prints a whole one, with what each key means"
        }
    }
}
