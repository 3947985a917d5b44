//! The campaign file, and the runs and jobs that it asks for. In: its text. Out: every run with its words, in
//! an order that is the same everywhere, so that a job is known by its number alone.

use std::collections::BTreeSet;
use std::ops::Range;
use std::path::PathBuf;

use serde::Deserialize;
use serde_json::Value;

use crate::CampaignError;

/// Commands that a campaign can make many times.
pub const COMMANDS: [&str; 4] = ["soak", "experiment", "tune", "run"];
/// Seeds of one command, where it takes a range of them and the file does not say.
const SEEDS_A_JOB: u64 = 20;
/// Runs that a campaign may have.
const MOST_RUNS: u64 = 1_000_000;
/// What a campaign gives each run itself.
const OURS: [&str; 7] = ["--json", "--out", "-o", "--quiet", "-q", "--page", "--panel"];
/// What keeps a run from being one of many that end by themselves and leave nothing for the next.
const NOT_MANY: [&str; 12] = [
    "--at",
    "--clock",
    "--processes",
    "--in-process",
    "--dry-run",
    "--listen",
    "--resume",
    "--parameters",
    "--help",
    "-h",
    "--version",
    "--",
];
/// Where seeds stand in a command: one, or the first and the one behind the last.
const SEED: &str = "{seed}";
const SEEDS: &str = "{seeds}";

/// As it is written.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    command: Vec<String>,
    #[serde(default)]
    seeds: Option<String>,
    #[serde(default)]
    per_job: Option<u64>,
    #[serde(default)]
    machine: Option<PathBuf>,
    #[serde(default)]
    vary: toml::Table,
}

/// A name and the values that it takes.
#[derive(Clone, Debug)]
struct Varied {
    name: String,
    values: Vec<toml::Value>,
    /// It stands in the command as `{name}`; else it is a key of the machine file.
    in_command: bool,
}

/// A campaign.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The text of its file.
    pub text: String,
    /// The machine file whose keys vary, or that every run takes.
    pub machine: Option<PathBuf>,
    /// Runs of one job, at most.
    pub per_job: u64,
    command: Vec<String>,
    seeds: Option<Range<u64>>,
    /// One command takes a range of seeds.
    ranges: bool,
    varied: Vec<Varied>,
}

/// A run: one command.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Its words behind `pitchlock`, without the machine file and what a campaign adds.
    pub words: Vec<String>,
    /// Which combination of values its machine file has: the number of that file.
    pub machine: Option<u64>,
    /// What was varied for it, and its seed where it has one: a column each.
    pub varied: Vec<(String, Value)>,
    /// Seeds that its document has to have, where it is asked for a range of them.
    pub seeds: Option<Range<u64>>,
}

impl Plan {
    /// Reads a campaign file; `name` is what messages call it.
    ///
    /// # Errors
    /// A key is unknown, missing or of the wrong kind, or what they say together is no campaign: which, why,
    /// and what to write.
    pub fn read(name: &str, text: &str) -> Result<Plan, CampaignError> {
        let wrong = |why: String| CampaignError::Input(format!("{name}: {why}"));
        let file: File = toml::from_str(text).map_err(|error| wrong(error.to_string()))?;
        let plan = Plan::of(file, text).map_err(wrong)?;
        match plan.count() {
            Some(runs) if runs <= MOST_RUNS => Ok(plan),
            _ => {
                Err(wrong(format!("more than {MOST_RUNS} runs: fewer seeds or values, or several campaigns")))
            }
        }
    }

    fn of(file: File, text: &str) -> Result<Plan, String> {
        let File { command, seeds, per_job, machine, vary } = file;
        let first = command.first().map_or("", String::as_str);
        if !COMMANDS.contains(&first) {
            let known = COMMANDS.join(", ");
            return Err(format!(
                "command: \"{first}\" cannot be made many times: begin with one of {known}, as in \
                 [\"soak\", \"--seeds\", \"{{seeds}}\"]"
            ));
        }
        // `-oFILE` is `-o FILE`.
        let option = |word: &String| match word.strip_prefix('-') {
            Some(short) if !short.starts_with('-') => {
                format!("-{}", short.chars().take(1).collect::<String>())
            }
            _ => word.split('=').next().unwrap_or_default().to_owned(),
        };
        if let Some(ours) = command.iter().map(option).find(|word| OURS.contains(&word.as_str())) {
            return Err(format!("command: a campaign says {ours} itself: leave it out"));
        }
        if let Some(not) = command.iter().map(option).find(|word| NOT_MANY.contains(&word.as_str())) {
            return Err(format!("command: nothing with {not} can be made many times: leave it out"));
        }
        if command.iter().any(|word| option(word) == "--machine") {
            return Err(
                "command: say the machine file as machine = \"FILE\", so that its keys can vary".into()
            );
        }
        let has = |mark: &str| command.iter().any(|word| word.contains(mark));
        let ranges = has(SEEDS);
        let seeds = seeds.as_deref().map(self::seeds).transpose().map_err(|why| format!("seeds: {why}"))?;
        match (&seeds, has(SEED), ranges) {
            (_, true, true) => return Err(format!("command: {SEED} and {SEEDS} in one: keep one of them")),
            (None, false, false) if first == "soak" => {
                return Err(format!(
                    "command: soak takes seeds: [\"soak\", \"--seeds\", \"{SEEDS}\"] and seeds = \"0..2000\""
                ));
            }
            (None, true, _) | (None, _, true) => {
                return Err(
                    "seeds is missing: write seeds = \"0..2000\", the first and the one behind the last"
                        .into(),
                );
            }
            (Some(_), false, false) => {
                return Err(format!(
                    "seeds: no word of the command has {SEED} or {SEEDS}: write --seed {SEED}, or leave seeds out"
                ));
            }
            _ => {}
        }
        let per_job = per_job.unwrap_or(if ranges { SEEDS_A_JOB } else { 1 });
        if per_job == 0 {
            return Err("per_job: 1 or more".into());
        }
        let varied = vary.into_iter().map(|(name, values)| Varied::of(name, values, &command));
        let varied = varied.collect::<Result<Vec<_>, _>>()?;
        if first == "soak"
            && let Some(key) = varied.iter().find(|varied| !varied.in_command)
        {
            return Err(format!("vary.\"{}\": soak draws its machines itself: leave it out", key.name));
        }
        if first == "soak" && machine.is_some() {
            return Err("machine: soak draws its machines itself: leave it out".into());
        }
        let plan = Plan { text: text.into(), machine, per_job, command, seeds, ranges, varied };
        plan.marks_are_known()?;
        Ok(plan)
    }

    /// Refuses a `{name}` that nobody fills.
    fn marks_are_known(&self) -> Result<(), String> {
        for word in &self.command {
            let mut rest = word.as_str();
            while let Some((_, behind)) = rest.split_once('{') {
                let Some((name, behind)) = behind.split_once('}') else { break };
                if !["seed", "seeds"].contains(&name) && !self.varied.iter().any(|varied| varied.name == name)
                {
                    return Err(format!(
                        "command: {{{name}}} has no values: write them as [vary] {name} = [1, 2]"
                    ));
                }
                rest = behind;
            }
        }
        Ok(())
    }

    /// Combinations of what varies, in the command and in the machine file.
    fn combinations(&self) -> Option<u64> {
        self.varied.iter().try_fold(1_u64, |all, varied| all.checked_mul(varied.values.len() as u64))
    }

    /// Runs of one combination.
    fn runs_each(&self) -> u64 {
        let seeds = self.seeds.as_ref().map_or(1, |seeds| seeds.end - seeds.start);
        if self.ranges { seeds.div_ceil(self.per_job) } else { seeds }
    }

    /// Runs of the whole campaign; none if there are more than can be counted.
    fn count(&self) -> Option<u64> {
        self.combinations()?.checked_mul(self.runs_each())
    }

    /// The number of jobs. They are known as 0, 1, 2 …
    pub fn jobs(&self) -> u64 {
        let runs = self.count().unwrap_or(0);
        if self.ranges { runs } else { runs.div_ceil(self.per_job) }
    }

    /// The runs of a job.
    pub fn runs(&self, job: u64) -> Vec<Run> {
        let many = if self.ranges { 1 } else { self.per_job };
        let all = self.count().unwrap_or(0);
        (job.saturating_mul(many)..all.min(job.saturating_add(1).saturating_mul(many)))
            .map(|n| self.run(n))
            .collect()
    }

    /// The run with this number: seeds change fastest, then the last name that varies.
    fn run(&self, number: u64) -> Run {
        let each = self.runs_each();
        let (combination, nth) = (number / each, number % each);
        let values = self.values(combination);
        let mut words = self.command.clone();
        let mut fill = |mark: &str, text: &str| {
            words.iter_mut().for_each(|word| *word = word.replace(mark, text));
        };
        let mut columns = Vec::new();
        for (varied, value) in &values {
            if varied.in_command {
                fill(&format!("{{{}}}", varied.name), &written(value));
            }
            columns.push((varied.name.clone(), serde_json::to_value(value).unwrap_or(Value::Null)));
        }
        let mut asked = None;
        if let Some(seeds) = &self.seeds {
            if self.ranges {
                let from = seeds.start + nth * self.per_job;
                let part = from..seeds.end.min(from.saturating_add(self.per_job));
                fill(SEEDS, &format!("{}..{}", part.start, part.end));
                asked = Some(part);
            } else {
                let seed = seeds.start + nth;
                fill(SEED, &seed.to_string());
                columns.push(("seed".into(), seed.into()));
            }
        }
        let machine = self.has_machines().then(|| self.machine_number(combination));
        Run { words, machine, varied: columns, seeds: asked }
    }

    /// What a combination gives each name.
    fn values(&self, mut combination: u64) -> Vec<(&Varied, &toml::Value)> {
        let mut values = Vec::with_capacity(self.varied.len());
        for varied in self.varied.iter().rev() {
            let many = varied.values.len() as u64;
            values.push((varied, &varied.values[(combination % many) as usize]));
            combination /= many;
        }
        values.reverse();
        values
    }

    /// Whether keys of the machine file vary.
    pub fn has_machines(&self) -> bool {
        self.varied.iter().any(|varied| !varied.in_command)
    }

    /// The number of the machine file of a combination: what varies in the command alone makes no new one.
    fn machine_number(&self, combination: u64) -> u64 {
        self.values(combination).into_iter().filter(|(varied, _)| !varied.in_command).fold(
            0,
            |number, (varied, value)| {
                let many = varied.values.len() as u64;
                number * many
                    + varied.values.iter().position(|one| std::ptr::eq(one, value)).unwrap_or(0) as u64
            },
        )
    }

    /// The number of machine files that are needed. They are known as 0, 1, 2 …
    pub fn machines(&self) -> u64 {
        let values = self.varied.iter().filter(|varied| !varied.in_command).map(|varied| varied.values.len());
        if self.has_machines() { values.map(|many| many as u64).product() } else { 0 }
    }

    /// What the machine file with this number has: keys with their values.
    pub fn keys(&self, mut number: u64) -> Vec<(&str, &toml::Value)> {
        let mut keys = Vec::new();
        for varied in self.varied.iter().rev().filter(|varied| !varied.in_command) {
            let many = varied.values.len() as u64;
            keys.push((varied.name.as_str(), &varied.values[(number % many) as usize]));
            number /= many;
        }
        keys.reverse();
        keys
    }

    /// The columns that a campaign gives its rows itself.
    pub fn columns(&self) -> Vec<String> {
        let ours = ["job", "command", "status"].map(String::from);
        let seed = (self.seeds.is_some() && !self.ranges).then(|| "seed".into());
        ours.into_iter().chain(self.varied.iter().map(|varied| varied.name.clone())).chain(seed).collect()
    }

    /// Every word of every command, seeds left as they are written.
    pub fn words(&self) -> BTreeSet<String> {
        let mut all: BTreeSet<String> = self.command.iter().cloned().collect();
        for varied in self.varied.iter().filter(|varied| varied.in_command) {
            let mark = format!("{{{}}}", varied.name);
            let marked = all.iter().filter(|word| word.contains(&mark));
            let fill = |word: &String| {
                varied.values.iter().map(|value| word.replace(&mark, &written(value))).collect::<Vec<_>>()
            };
            let filled: Vec<String> = marked.flat_map(fill).collect();
            all.extend(filled);
        }
        all
    }
}

impl Varied {
    fn of(name: String, values: toml::Value, command: &[String]) -> Result<Varied, String> {
        let in_command = command.iter().any(|word| word.contains(&format!("{{{name}}}")));
        if ["seed", "seeds", "job", "command", "status"].contains(&name.as_str()) {
            return Err(format!("vary.{name}: the table has a column of that name already: choose another"));
        }
        if !in_command && !name.contains('.') {
            return Err(format!(
                "vary.{name}: neither {{{name}}} in the command nor a key of the machine file, such as \"axis.x.mass_kg\""
            ));
        }
        let toml::Value::Array(values) = values else {
            return Err(format!("vary.\"{name}\": a list of values: [{}]", values));
        };
        let simple = |value: &toml::Value| !matches!(value, toml::Value::Table(_) | toml::Value::Datetime(_));
        if values.is_empty() || !values.iter().all(simple) {
            return Err(format!(
                "vary.\"{name}\": one or more numbers, texts, true or false, or lists of them"
            ));
        }
        Ok(Varied { name, values, in_command })
    }
}

/// A value as a word of a command.
fn written(value: &toml::Value) -> String {
    match value {
        toml::Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

/// A range of seeds, as it is written: `0..2000`.
///
/// # Errors
/// It is none, or holds no seed: what to write.
pub fn seeds(text: &str) -> Result<Range<u64>, String> {
    let number = |text: &str| text.trim().replace('_', "").parse::<u64>().ok();
    let both = text.split_once("..").and_then(|(from, to)| Some(number(from)?..number(to)?));
    let range = both.ok_or("write the first seed and the one behind the last, such as 0..2000")?;
    if range.is_empty() {
        Err(format!("{text} holds no seed: write it as {0}..{1}", range.start, range.start + 1))
    } else {
        Ok(range)
    }
}
