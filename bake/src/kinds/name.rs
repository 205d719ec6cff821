//! What a landscape is called: by the kinds of its parts.

use genescape_schema::Category;

use super::Home;

/// "Birches on karst, mackerel sky"; `None` if one of the parts is like no kind. In the order of [`Category::ALL`].
pub fn landscape(homes: [Home<'_>; 3]) -> Option<String> {
    let [tree, terrain, sky] = homes.map(|home| home.main().map(|kind| kind.name.as_str()));
    Some(format!("{} {}, {}", tree?, terrain?, sky?))
}

/// What one part is called in a list of parts: "birches", "on karst", "mackerel sky".
pub fn part(category: Category, home: Home<'_>) -> Option<String> {
    let name = &home.main()?.name;
    let mut letters = name.chars();
    match category {
        Category::Tree => letters.next().map(|first| first.to_lowercase().chain(letters).collect()),
        _ => Some(name.clone()),
    }
}
