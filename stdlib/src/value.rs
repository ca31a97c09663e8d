//! tmp
use crate::elem::Elem;
pub fn format_scalar(_: Elem, raw: u64) -> String {
    raw.to_string()
}
pub fn parse_integer(_: &str) -> Result<i128, String> {
    todo!()
}
pub fn parse_real(_: &str) -> Result<f64, String> {
    todo!()
}
pub fn parse_elem(_: Elem, _: &str) -> Result<u64, String> {
    todo!()
}
pub fn parse_string(_: &str, _: bool) -> Result<Vec<u8>, String> {
    todo!()
}
pub fn parse_wstring(_: &str, _: bool) -> Result<Vec<u16>, String> {
    todo!()
}
