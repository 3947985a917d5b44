//! What programs are judged with: a machine, and how they are read. In: arguments, and what the editor says
//! as it starts. Out: [`Settings`].

use std::path::{Path, PathBuf};

use interpreter::Language;
use machine::Machine;
use serde::Deserialize;

/// What programs are judged with.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The machine they are for.
    pub machine: Machine,
    /// How they are read.
    pub language: Language,
    /// Where the pages of `docs/` are, as an address; codes of diagnostics lead there.
    pub docs: Option<String>,
}

/// What an editor may say of them; a key that is absent leaves what the arguments said. A machine brings its
/// tools and parameters, or none.
#[derive(Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Said {
    machine: Option<PathBuf>,
    dialect: Option<String>,
    tools: Option<PathBuf>,
    subroutines: Vec<PathBuf>,
    docs: Option<String>,
}

impl Settings {
    /// The settings with what an editor says; a path that is not absolute begins at `folder`.
    ///
    /// # Errors
    /// What is wrong with it, for people.
    pub(crate) fn with(
        mut self,
        said: &serde_json::Value,
        folder: Option<&Path>,
    ) -> Result<Settings, String> {
        if said.is_null() {
            return Ok(self);
        }
        let said: Said =
            Said::deserialize(said).map_err(|error| format!("initialization options: {error}"))?;
        let at = |path: PathBuf| folder.map_or_else(|| path.clone(), |folder| folder.join(&path));
        if let Some(path) = said.machine.map(at) {
            let wrong = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
            let text = intake::text(&path, intake::SETTINGS).map_err(|error| wrong(&error))?;
            self.machine = Machine::from_toml(&text).map_err(|error| wrong(&error))?;
            let beside =
                |file: &PathBuf| path.parent().map_or_else(|| file.clone(), |folder| folder.join(file));
            let machine::General { tool_table, parameters, .. } = &self.machine.general;
            self.language.tools = tool_table.as_ref().map(beside);
            self.language.parameters = parameters.as_ref().map(beside);
        }
        if let Some(name) = said.dialect {
            self.language.dialect = Some(dialect(&name)?);
        }
        self.language.tools = said.tools.map(at).or(self.language.tools);
        self.language.subroutines.extend(said.subroutines.into_iter().map(at));
        self.docs = said.docs.or(self.docs);
        Ok(self)
    }
}

fn dialect(name: &str) -> Result<machine::ProgramDialect, String> {
    use machine::ProgramDialect::{Auto, Fanuc, Linuxcnc};
    let all = [Auto, Fanuc, Linuxcnc];
    let found = all.into_iter().find(|dialect| dialect.name() == name);
    found.ok_or_else(|| format!("initialization options: dialect {name}: auto, linuxcnc or fanuc"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_machine_brings_its_tools_and_its_parameters() {
        let folder = tempfile::tempdir().expect("a folder");
        let text = machine::SMALL_LATHE.replacen(
            "[machine]\n",
            "[machine]\ntool_table = \"my.tbl\"\nparameters = \"my.var\"\n",
            1,
        );
        std::fs::write(folder.path().join("lathe.toml"), text).expect("room");
        let machine = Machine::from_toml(machine::SMALL_LATHE).expect("it is good");
        let settings = Settings { machine, language: Language::default(), docs: None };
        let said = serde_json::json!({ "machine": "lathe.toml" });
        let language = settings.with(&said, Some(folder.path())).expect("it is right").language;
        let files = ["my.tbl", "my.var"].map(|name| Some(folder.path().join(name)));
        assert_eq!([language.tools, language.parameters], files);
    }
}
