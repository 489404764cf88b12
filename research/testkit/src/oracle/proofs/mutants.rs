//! Generates mutants of a proof without regard to its meaning: changes of numbers, names and lists of its JSON.

use serde_json::{Map, Number, Value};

use crate::random::Random;

/// Returns the JSON pointers of all values in a file, containers before their contents.
pub fn pointers(value: &Value) -> Vec<String> {
    let mut found = Vec::new();
    collect(value, String::new(), &mut found);
    found
}

fn collect(value: &Value, at: String, found: &mut Vec<String>) {
    match value {
        Value::Object(fields) => {
            for (name, part) in fields {
                collect(part, format!("{at}/{name}"), found);
            }
        }
        Value::Array(parts) => {
            for (k, part) in parts.iter().enumerate() {
                collect(part, format!("{at}/{k}"), found);
            }
        }
        _ => {}
    }
    found.push(at);
}

/// Returns a file with another value at a pointer; `None` removes the value from its object or list.
pub fn with(file: &Value, pointer: &str, value: Option<Value>) -> Value {
    let mut file = file.clone();
    if let Some(value) = value {
        if let Some(at) = file.pointer_mut(pointer) {
            *at = value;
        }
        return file;
    }
    if let Some((parent, name)) = pointer.rsplit_once('/') {
        match file.pointer_mut(parent) {
            Some(Value::Object(fields)) => {
                fields.remove(name);
            }
            Some(Value::Array(parts)) => {
                if let Ok(k) = name.parse::<usize>().map(|k| k.min(parts.len().saturating_sub(1))) {
                    parts.remove(k);
                }
            }
            _ => {}
        }
    }
    file
}

/// Converts a number to JSON; `null` if it is not finite.
pub fn number(x: f64) -> Value {
    Number::from_f64(x).map_or(Value::Null, Value::Number)
}

/// Returns a mutant of a file as text: a random change of a random value. More than half of the changes are
/// below the pointer `focus`.
pub fn random(file: &Value, focus: &str, random: &mut Random) -> String {
    let all = pointers(file);
    let near: Vec<&String> = all.iter().filter(|at| at.starts_with(focus)).collect();
    let at = if random.one_in(3) || near.is_empty() {
        all[random.index(all.len())].clone()
    } else {
        near[random.index(near.len())].clone()
    };
    let old = file.pointer(&at).cloned().unwrap_or(Value::Null);
    if random.one_in(40) {
        return raw(file, &at, &old, random);
    }
    let change = if random.one_in(8) { other_type(&old, random) } else { changed(&old, random) };
    with(file, &at, change).to_string()
}

/// Returns a file in which a part is replaced by that of another proof; `None` if no part differs.
pub fn graft(file: &Value, other: &Value, random: &mut Random) -> Option<String> {
    let differs = |at: &String| {
        let (own, others) = (file.pointer(at), other.pointer(at));
        own.is_some() && own != others && others.is_some_and(|part| !part.is_number())
    };
    let places: Vec<String> = pointers(other).into_iter().filter(differs).collect();
    // The last entry is the whole file.
    let (_, inner) = places.split_last()?;
    let at = inner.get(random.index(inner.len().max(1)))?;
    Some(with(file, at, other.pointer(at).cloned()).to_string())
}

/// Returns a change of a value within its type.
fn changed(old: &Value, random: &mut Random) -> Option<Value> {
    Some(match old {
        Value::Number(x) if x.is_f64() => number(other_number(x.as_f64().unwrap_or(0.0), random)),
        Value::Number(x) => {
            let x = x.as_i64().unwrap_or(0);
            let end = i64::from(u32::MAX);
            Value::from(match random.index(6) {
                0 => x + 1,
                1 => x - 1,
                2 => 0,
                3 => end,
                4 => end + 1,
                _ => random.int(0, 12),
            })
        }
        Value::Array(parts) if !parts.is_empty() => {
            let mut parts = parts.clone();
            let (i, j) = (random.index(parts.len()), random.index(parts.len()));
            match random.index(5) {
                0 => parts.swap(i, j),
                1 => parts.reverse(),
                2 => parts.push(parts[i].clone()),
                3 => parts[i] = parts[j].clone(),
                _ => {
                    parts.remove(i);
                }
            }
            Value::Array(parts)
        }
        Value::Object(fields) => {
            let mut fields: Map<String, Value> = fields.clone();
            let names: Vec<String> = fields.keys().cloned().collect();
            if names.is_empty() || random.one_in(3) {
                fields.insert("unknown".into(), Value::from(1.0));
            } else if random.one_in(2) {
                fields.remove(&names[random.index(names.len())]);
            } else {
                fields.insert(names[random.index(names.len())].clone(), Value::Null);
            }
            Value::Object(fields)
        }
        Value::Bool(x) => Value::Bool(!x),
        _ => return None,
    })
}

/// Returns a number near another one, or one at an end of the range.
pub fn other_number(x: f64, random: &mut Random) -> f64 {
    let tiny = f64::from_bits(1);
    let least = colltrans::MIN_MAGNITUDE;
    match random.index(16) {
        0 => x.next_up(),
        1 => x.next_down(),
        2 => x + 64.0 * f64::EPSILON * x,
        3 => x - 64.0 * f64::EPSILON * x,
        4 => x * (1.0 + 1e-12),
        5 => x * (1.0 - 1e-9),
        6 => -x,
        7 => 0.0,
        8 => -0.0,
        9 => tiny,
        10 => random.pick(&[least, least.next_down(), -least.next_down(), 2.0 * least]),
        11 => random.pick(&[1e300, -1e300, 1e61, colltrans::MAX_MAGNITUDE]),
        12 => x + random.range(-1.0, 1.0),
        13 => x * random.range(0.0, 2.0),
        14 => x + random.pick(&[1e-15, -1e-15, 1e-9, -1e-9]),
        _ => random.pick(&[1.0, -1.0, 1e-300, 0.5]),
    }
}

/// Returns a value of another type; `None` removes it.
fn other_type(old: &Value, random: &mut Random) -> Option<Value> {
    Some(match random.index(8) {
        0 => Value::Null,
        1 => Value::Bool(true),
        2 => Value::String("1.0".into()),
        3 => Value::Array(vec![old.clone()]),
        4 => Value::Object(Map::new()),
        5 => Value::Array(Vec::new()),
        6 => number(random.range(-2.0, 2.0)),
        _ => return None,
    })
}

/// Returns the file with text at a pointer that is unusual or invalid in JSON.
fn raw(file: &Value, at: &str, old: &Value, random: &mut Random) -> String {
    let mark = "\"a mark\"";
    let text = with(file, at, Some(Value::String("a mark".into()))).to_string();
    let numbers = ["NaN", "Infinity", "-Infinity", "1e999", "-0", "00", "1e-999", "0x1", "1.", ""];
    let by = match random.index(12) {
        k @ 0..10 => numbers[k].to_owned(),
        10 => format!("{old},{old}"),
        _ => format!("{old},\"format\":{old}"),
    };
    text.replacen(mark, &by, 1)
}
