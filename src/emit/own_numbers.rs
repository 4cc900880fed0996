//! A company's own article numbers, from a table that its order system writes.

use std::collections::BTreeMap;

/// Own article numbers by the catalogue's.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct OwnNumbers(BTreeMap<String, String>);

impl OwnNumbers {
    pub fn of(&self, article: &str) -> Option<&str> {
        self.0.get(article).map(String::as_str)
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

/// Most numbers of a table.
const MOST: usize = 100_000;

/// Reads a table: a row an article, the catalogue's number and the own one, separated by a comma, a semicolon or a
/// tab; further columns are not read. The first row may name the columns: its first field is then `article`.
///
/// # Errors
/// In words with the line, behind the file's name: `:3: no own number beside ST-3000`.
pub fn own_numbers(bytes: &[u8]) -> Result<OwnNumbers, String> {
    let text = std::str::from_utf8(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)).map_err(|why| {
        let line = bytes[..why.valid_up_to()].iter().filter(|byte| **byte == b'\n').count() + 1;
        format!(":{line}: not UTF-8; save the table as CSV in UTF-8")
    })?;
    let first = text.lines().next().unwrap_or_default();
    let separator = [';', '\t'].into_iter().find(|c| first.contains(*c)).unwrap_or(',');
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(separator as u8)
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let mut numbers: BTreeMap<String, (String, u64)> = BTreeMap::new();
    for (row, record) in reader.records().enumerate() {
        let record = record.map_err(|why| format!(": {why}"))?;
        let line = record.position().map_or(row as u64 + 1, csv::Position::line);
        let field = |k: usize| record.get(k).unwrap_or_default();
        let (article, own) = (field(0), field(1));
        if (row == 0 && article.eq_ignore_ascii_case("article")) || record.iter().all(str::is_empty) {
            continue;
        }
        if own.is_empty() {
            return Err(format!(
                ":{line}: no own number beside `{article}`\n  help: a row is `ST-3000;100.233.1`, the catalogue's number and yours"
            ));
        }
        if numbers.len() == MOST {
            return Err(format!(":{line}: more than {MOST} articles"));
        }
        if let Some((other, before)) = numbers.insert(article.to_owned(), (own.to_owned(), line))
            && other != own
        {
            return Err(format!(":{line}: `{article}` is {own} here and {other} in line {before}"));
        }
    }
    Ok(OwnNumbers(numbers.into_iter().map(|(article, (own, _))| (article, own)).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_of_order_systems_are_read() {
        for text in [
            "article,number\nST-3000,100.233.1\nCU-4000-45,\"100,7\"\n",
            "\u{feff}Article;Own number;Text\r\nST-3000;100.233.1;straight\r\nCU-4000-45;100,7;\r\n;;\r\n",
            "ST-3000\t100.233.1\nCU-4000-45\t100,7",
        ] {
            let own = own_numbers(text.as_bytes()).unwrap();
            assert_eq!((own.of("ST-3000"), own.of("CU-4000-45")), (Some("100.233.1"), Some("100,7")), "{text}");
            assert_eq!(own.of("ST-1000"), None);
        }
        assert!(own_numbers(b"").unwrap().is_empty());
    }

    #[test]
    fn a_table_with_a_mistake_says_where() {
        let why = |bytes: &[u8]| own_numbers(bytes).unwrap_err();
        assert!(why(b"article;number\nST-3000;\n").starts_with(":2: no own number beside `ST-3000`"));
        assert_eq!(why(b"a;1\nb;2\na;3\n"), ":3: `a` is 3 here and 1 in line 1");
        assert!(why(b"a;1\nb;\xfc\n").starts_with(":2: not UTF-8"));
    }
}
