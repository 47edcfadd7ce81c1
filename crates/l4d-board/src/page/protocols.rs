//! What the page knows of the protocols of others: their tables when it opens, values of queries with the scenes.

use std::collections::HashMap;

use l4d_data::{Category, Query, QueryId, Scale};
use serde_json::{Map, Value, json};

use super::overview::{group_key, hundredths, link};
use crate::detail::{Asked, AskedScene};
use crate::protocols::{ProtocolRow, ProtocolTable, numbers};
use crate::rank::Board;

/// The tables, one a protocol.
pub(crate) fn overview(tables: &[ProtocolTable], board: &Board, asked: &Asked) -> Value {
    let queries: HashMap<&QueryId, (&Query, Scale)> =
        asked.queries().map(|(query, scale)| (&query.id, (query, scale))).collect();
    let table = |table: &ProtocolTable| {
        let measures = table.protocol.measures().iter();
        let method = |row: &ProtocolRow| {
            let scenes = asked.scenes.iter().map(|asked| row.scenes.get(&asked.scene.name));
            json!({
                "name": row.name,
                "version": row.version,
                "link": link(&row.link),
                "rank": null,
                "reasons": row.remarks,
                "queries": row.queries,
                "leftOut": row.left_out,
                "isDetailed": row.sheet.is_some(),
                "groups": groups(row, &queries),
                "scenes": scenes.map(|found| found.map(|found| shown(found))).collect::<Value>(),
            })
        };
        json!({
            "name": table.protocol.as_str(),
            "source": table.protocol.source(),
            "remark": table.protocol.remark(),
            "line": table.line(board),
            "measures": measures.map(|one| json!({ "key": one.key, "title": one.title })).collect::<Value>(),
            "methods": table.rows.iter().map(method).collect::<Value>(),
        })
    };
    tables.iter().map(table).collect()
}

/// Protocol -> method -> the values of each query of a scene, in the order in which the scene asks.
pub(crate) fn scene(tables: &[ProtocolTable], asked: &AskedScene) -> Value {
    let of_table = |table: &ProtocolTable| {
        let of_row = |row: &ProtocolRow| {
            let sheet = row.sheet.as_ref()?;
            let of_query: HashMap<&QueryId, _> =
                sheet.rows.iter().map(|row| (&row.id, &row.judged.values)).collect();
            let values = asked.queries.iter().map(|query| {
                let values = of_query.get(&query.id)?;
                let percent = values.iter().map(|value| value.map(|value| hundredths(100.0 * value.mean)));
                Some(percent.collect::<Vec<_>>())
            });
            Some((row.name.to_string(), json!(values.collect::<Vec<_>>())))
        };
        let methods: Map<String, Value> = table.rows.iter().filter_map(of_row).collect();
        (table.protocol.to_string(), Value::Object(methods))
    };
    Value::Object(tables.iter().map(of_table).collect())
}

/// Every group of queries that the page can show, averaged as the protocol does.
fn groups(row: &ProtocolRow, queries: &HashMap<&QueryId, (&Query, Scale)>) -> Map<String, Value> {
    let mut groups = Map::from_iter([(group_key(None, None), shown(&row.numbers))]);
    let Some(sheet) = &row.sheet else { return groups };
    let categories = || [None].into_iter().chain(Category::ALL.map(Some));
    let scales = || [None].into_iter().chain(Scale::ALL.map(Some));
    for (category, scale) in categories().flat_map(|category| scales().map(move |scale| (category, scale))) {
        let found = sheet.of(|id| {
            queries.get(id).is_some_and(|(query, of)| {
                category.is_none_or(|category| query.categories.contains(&category))
                    && scale.is_none_or(|scale| scale == *of)
            })
        });
        let is_new = !(category.is_none() && scale.is_none());
        if is_new && !found.rows.is_empty() {
            groups.insert(group_key(category, scale), shown(&numbers(&found)));
        }
    }
    groups
}

fn shown(numbers: &[Option<f64>]) -> Value {
    numbers.iter().map(|number| number.map(hundredths)).collect()
}
