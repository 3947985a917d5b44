//! What is handed to Slurm, which is what clusters have: one array for the jobs that are not done. Whatever
//! else numbers its tasks takes `--job N` as well.

use std::path::Path;

use super::CampaignArgs;
use crate::error::CliError;

/// Tasks of an array that Slurm takes unless its administrator says more (`MaxArraySize`, slurm.conf).
const MOST_TASKS: u64 = 1001;

/// The script for these jobs of a campaign with this folder.
///
/// # Errors
/// There are none, or a path is none of a script.
pub(super) fn script(args: &CampaignArgs, root: &Path, jobs: &[u64]) -> Result<String, CliError> {
    let Some(last) = jobs.last() else {
        let text = format!(
            "every job is done: `pitchlock campaign {} --merge` makes the table",
            args.file.display()
        );
        return Err(CliError::Machine(text));
    };
    if *last >= MOST_TASKS {
        crate::words::say(&format!(
            "warning: job {last} is beyond what Slurm takes unless its MaxArraySize says more ({MOST_TASKS}): a larger \
             per_job makes fewer jobs\n"
        ));
    }
    let of_system = |error: std::io::Error| CliError::Machine(error.to_string());
    let this = quoted(&std::env::current_exe().map_err(of_system)?)?;
    let here = quoted(&std::env::current_dir().map_err(of_system)?)?;
    let (file, root, array) = (quoted(&args.file)?, quoted(root)?, ranges(jobs));
    Ok(format!(
        "#!/bin/sh\n#SBATCH --job-name=pitchlock\n#SBATCH --array={array}\n#SBATCH --cpus-per-task=1\n#SBATCH --requeue\n\
         #SBATCH --output=/dev/null\n#SBATCH --error=pitchlock-%A-%a.err\n#SBATCH --open-mode=append\ncd {here} || exit 1\n\
         exec {this} campaign {file} --out {root} --job \"$SLURM_ARRAY_TASK_ID\" --quiet\n"
    ))
}

/// Numbers as a scheduler has them: `0-3,7,9-11`.
fn ranges(numbers: &[u64]) -> String {
    let mut parts: Vec<(u64, u64)> = Vec::new();
    for number in numbers {
        match parts.last_mut() {
            Some((_, last)) if *last + 1 == *number => *last = *number,
            _ => parts.push((*number, *number)),
        }
    }
    let part = |(first, last): &(u64, u64)| {
        if first == last { first.to_string() } else { format!("{first}-{last}") }
    };
    parts.iter().map(part).collect::<Vec<_>>().join(",")
}

/// A path as a word of a shell.
fn quoted(path: &Path) -> Result<String, CliError> {
    let text = path.to_str().ok_or_else(|| CliError::file(path, "is no UTF-8: rename it for a script"))?;
    Ok(quote(text))
}

/// A text as a word of a shell.
pub(super) fn quote(text: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "_./=:,+@%-".contains(c);
    if !text.is_empty() && text.chars().all(plain) {
        return text.into();
    }
    format!("'{}'", text.replace('\'', "'\\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_as_ranges() {
        assert_eq!(ranges(&[0, 1, 2, 3, 7, 9, 10]), "0-3,7,9-10");
        assert_eq!(ranges(&[5]), "5");
    }

    #[test]
    fn a_name_is_one_word_of_a_shell() {
        assert_eq!(quoted(Path::new("it's")).ok().as_deref(), Some("'it'\\''s'"));
    }
}
