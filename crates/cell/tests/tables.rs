//! Tables of numbers that a cell file refers to.

use elbowroom_cell::NumberTable;

#[test]
fn numbers_in_quotes_are_numbers() {
    let table = NumberTable::parse("s.csv".as_ref(), "\"x\",\"y\"\r\n\"0.5\",1\r\n").unwrap();
    assert_eq!(table.rows[0].1, [0.5, 1.0]);
    assert!(NumberTable::parse("s.csv".as_ref(), "x\n\"0.5\n").is_err());
}
