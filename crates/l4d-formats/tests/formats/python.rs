use l4d_formats::python::{Literal, namespace};

use super::bytes;

/// Options by name.
struct Options(Vec<(String, Literal)>);

impl Options {
    fn parse(text: &str) -> Self {
        Self(namespace(text).unwrap())
    }

    fn get(&self, name: &str) -> Option<&Literal> {
        self.0.iter().find(|(known, _)| known == name).map(|(_, value)| value)
    }
}

fn text(value: &str) -> Literal {
    Literal::Text(value.to_owned())
}

#[test]
fn values_are_those_that_python_had() {
    let args = Options::parse(&String::from_utf8(bytes("cfg_args.txt")).unwrap());
    assert_eq!(args.get("quotes"), Some(&text("'\"")));
    assert_eq!(args.get("escape"), Some(&text("tab\t, line\n, bell\u{7}, back\\slash")));
    assert_eq!(args.get("unicode"), Some(&text("na\u{ef}ve \u{2603}")));
    assert_eq!(args.get("small"), Some(&Literal::Float(1e-5)));
    assert_eq!(args.get("third"), Some(&Literal::Float(1.0 / 3.0)));
    assert_eq!(args.get("count"), Some(&Literal::Int(i64::MIN)));
    assert_eq!(args.get("one"), Some(&Literal::Tuple(vec![Literal::Int(1)])));
    assert_eq!(args.get("none"), Some(&Literal::None));
    let flags = Literal::Tuple(vec![Literal::Bool(true), Literal::Bool(false)]);
    let inner = Literal::Dict(vec![(Literal::Int(2), flags)]);
    let expected = vec![(text("a"), Literal::List(vec![Literal::Int(1), inner])), (text("b"), Literal::None)];
    assert_eq!(args.get("nested"), Some(&Literal::Dict(expected)));
    assert_eq!(args.get("absent"), None);
}

#[test]
fn blanks_commas_and_escapes_of_other_writers_are_understood() {
    let args = Options::parse(
        " Namespace( a = ( 1 ) ,\n b=[1, 2,], c='\\x41\\u2603\\U0001f600', d=+.5, e=inf, f=-inf, ) \n",
    );
    assert_eq!(args.get("a"), Some(&Literal::Int(1)));
    assert_eq!(args.get("b"), Some(&Literal::List(vec![Literal::Int(1), Literal::Int(2)])));
    assert_eq!(args.get("c"), Some(&text("A\u{2603}\u{1f600}")));
    assert_eq!(args.get("d"), Some(&Literal::Float(0.5)));
    assert_eq!(args.get("e"), Some(&Literal::Float(f64::INFINITY)));
    assert_eq!(args.get("f"), Some(&Literal::Float(f64::NEG_INFINITY)));
    assert_eq!(namespace("Namespace()").unwrap(), []);
}

#[test]
fn nothing_is_evaluated() {
    let refused = |text: &str| namespace(text).unwrap_err().to_string();
    let call = refused("Namespace(a=1, b=__import__('os').system('rm -rf /'))");
    assert_eq!(
        call,
        "byte 17: is `__import__('os').system(`, which is no literal; nothing here is evaluated"
    );
    for hostile in [
        "__import__('os')",
        "Namespace(a=1) or exit()",
        "Namespace(a=1+1)",
        "Namespace(a='x'.upper())",
        "Namespace(a='x' 'y')",
        "Namespace(a=[x for x in 'y'])",
        "Namespace(a=lambda: 0)",
        "Namespace(a=f'{1}')",
        "Namespace(a=b'x')",
        "Namespace(a={1, 2})",
        "Namespace(a=set())",
        "Namespace(a=True if 1 else 2)",
        "Namespace(*[1])",
        "Namespace(**{})",
        "Namespace(1)",
        "Namespace(a)",
        "Namespace(a==1)",
        "Namespace(1a=1)",
        "Namespace(a=0x10)",
        "Namespace(a=1_000)",
        "Namespace(a=1j)",
        "Namespace(a=infinity)",
        "Namespace(a=--1)",
        "Namespace(a=9223372036854775808)",
        "Namespace(a='\\N{DASH}')",
        "Namespace(a='\\x4')",
        "Namespace(a='\\ud800')",
        "Namespace(a=',",
        "Namespace(a='\n')",
        "Namespace(a=[1, 2",
        "Namespace(a={1:})",
        "Namespace(a=1, a=2)",
        "Namespace(a=1,,b=2)",
        "Namespace(a=1 b=2)",
        "Namespace",
        "",
    ] {
        refused(hostile);
    }
}

#[test]
fn deep_nesting_is_refused() {
    let nested = format!("Namespace(a={}{})", "[".repeat(100_000), "]".repeat(100_000));
    assert!(namespace(&nested).unwrap_err().to_string().contains("nested more than 32 deep"));
}
