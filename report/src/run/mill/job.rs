//! The tool of a job, in a file of its own or in a program. In: its text. Out: mm.

use toml::{Table, Value};

/// The tool of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct JobTool {
    pub(super) diameter_mm: f64,
    /// Of a flat end mill nothing, of a ball its radius.
    pub(super) corner_mm: f64,
}

fn number(value: &Value) -> Option<f64> {
    value.as_float().or(value.as_integer().map(|whole| whole as f64))
}

/// The tool that a job file says, or the jobs of a program, if they have one in common; `None` of any other
/// program.
pub(super) fn tool(program: &str) -> Option<JobTool> {
    let mut lines = program.lines().map(gcode::job_line);
    let mut tools = std::iter::from_fn(|| {
        let first = lines.find_map(|line| line)?;
        let job: Vec<&str> = std::iter::once(first).chain(lines.by_ref().map_while(|line| line)).collect();
        Some(of_job(&job.join("\n")))
    });
    match tools.next() {
        Some(first) => first.filter(|_| tools.all(|other| other == first)),
        // Jobs are shorter (gcode: half a megabyte), so a long text is a program without one.
        None if program.len() as u64 > intake::SETTINGS => None,
        None => of_job(program),
    }
}

fn of_job(text: &str) -> Option<JobTool> {
    let file: Table = text.parse().ok()?;
    let job = file.get("job").and_then(Value::as_table).unwrap_or(&file);
    let tool = job.get("tool")?;
    let diameter_mm = number(tool.get("diameter_mm")?)?;
    let corner_mm = match tool.get("kind")?.as_str()? {
        "ball" => 0.5 * diameter_mm,
        "bull" => number(tool.get("corner_mm")?)?,
        _ => 0.0,
    };
    Some(JobTool { diameter_mm, corner_mm })
}

#[cfg(test)]
mod tests {
    use super::{JobTool, tool};

    #[test]
    fn a_job_says_its_tool() {
        let said = |tool: &str| format!("[job]\nkind = \"surface\"\ntool = {{ {tool}, diameter_mm = 6 }}\n");
        for (text, corner_mm) in
            [("kind = \"ball\"", 3.0), ("kind = \"flat\"", 0.0), ("kind = \"bull\", corner_mm = 0.5", 0.5)]
        {
            assert_eq!(tool(&said(text)), Some(JobTool { diameter_mm: 6.0, corner_mm }), "{text}");
        }
        let lines = said("kind = \"ball\"").replace("[job]\n", "").replace('\n', "\n;@ ");
        let ball = JobTool { diameter_mm: 6.0, corner_mm: 3.0 };
        let program = format!("G21\n;@ {lines}\nG0 Z50\n;@ {lines}\nM2\n");
        assert_eq!(tool(&program), Some(ball), "{program}");
        let other = program.replacen("ball", "flat", 1);
        assert_eq!(tool(&other), None, "which of them cut what is not known");
        assert_eq!((tool("G1 X10 F100\nM2\n"), tool("feed_mm_min = 900")), (None, None));
    }
}
