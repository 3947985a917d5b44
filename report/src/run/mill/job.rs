//! The tool of a job file. In: its text. Out: mm.

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

/// The tool that a job says; `None` of any other program.
pub(super) fn tool(program: &str) -> Option<JobTool> {
    let file: Table = program.parse().ok()?;
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
        assert_eq!((tool("G1 X10 F100\nM2\n"), tool("feed_mm_min = 900")), (None, None));
    }
}
