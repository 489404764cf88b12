//! Fields of JSON objects, read by hand, because derived readers would add a third to the download.

use serde_json::{Map, Value};

/// The fields of an object.
pub(crate) struct Fields<'a>(&'a Map<String, Value>);

impl<'a> Fields<'a> {
    /// Returns the fields of a JSON value, or an error if it is not an object.
    pub(crate) fn from_value(value: &'a Value) -> Result<Self, String> {
        value.as_object().map(Self).ok_or_else(|| "it is not an object".into())
    }

    /// Returns a field; `None` if it is missing or null.
    pub(crate) fn get(&self, key: &str) -> Option<&'a Value> {
        self.0.get(key).filter(|value| !value.is_null())
    }

    /// Returns a field, or an error if it is missing or null.
    pub(crate) fn required(&self, key: &str) -> Result<&'a Value, String> {
        self.get(key).ok_or_else(|| format!("{key} is missing"))
    }

    pub(crate) fn text(&self, key: &str) -> Result<&'a str, String> {
        self.required(key)?.as_str().ok_or_else(|| format!("{key} is not text"))
    }

    pub(crate) fn flag(&self, key: &str) -> bool {
        self.get(key).and_then(Value::as_bool).unwrap_or(false)
    }

    pub(crate) fn number(&self, key: &str) -> Result<Option<f64>, String> {
        let number = |value: &Value| value.as_f64().ok_or_else(|| format!("{key} is not a number"));
        self.get(key).map(number).transpose()
    }

    pub(crate) fn list(&self, key: &str) -> Result<Vec<f64>, String> {
        numbers(self.required(key)?).ok_or_else(|| format!("{key} is not a list of numbers"))
    }

    pub(crate) fn array<const N: usize>(&self, key: &str) -> Result<[f64; N], String> {
        self.list(key)?.try_into().map_err(|_| format!("{key} does not hold {N} numbers"))
    }
}

fn numbers(value: &Value) -> Option<Vec<f64>> {
    value.as_array()?.iter().map(Value::as_f64).collect()
}
