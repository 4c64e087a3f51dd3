import { Stack } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import { searchQuery } from "../api/queries";
import { Empty } from "../components/display/Empty";
import { Loaded } from "../components/display/Loaded";
import { PageHead } from "../components/frame/PageHead";
import { SearchForm } from "../components/structures/SearchForm";
import { SearchResult } from "../components/structures/SearchResult";
import type { SearchView } from "../views";

const route = getRouteApi("/search");

/** Model structure determination: search for the terms of a model. */
export function SearchPage() {
  const view = route.useSearch();
  const navigate = route.useNavigate();
  const change = (part: Partial<SearchView>) =>
    void navigate({ search: (previous) => ({ ...previous, ...part }) });
  return (
    <>
      <PageHead
        title="Structure search"
        trail={[
          <Link to="/model-structures" className="link" key="structures">
            Model structures
          </Link>,
        ]}
      />
      <div className="split split-early">
        <SearchForm view={view} onChange={change} />
        {view.id === undefined ? (
          <div className="panel">
            <Empty title="No search selected">
              Select maneuvers and modes and start a search, or open a previous one. Equation error
              selects the terms of each coefficient; output error and frequency response error fit
              whole models, remove terms by Wald’s test and add them by the score test.
            </Empty>
          </div>
        ) : (
          <Shown id={view.id} view={view} onChange={change} />
        )}
      </div>
    </>
  );
}

interface ShownProps {
  id: number;
  view: SearchView;
  onChange: (change: Partial<SearchView>) => void;
}

function Shown({ id, view, onChange }: ShownProps) {
  const search = useQuery(searchQuery(id));
  return (
    <Stack gap="md" miw={0}>
      <Loaded query={search} rows={8}>
        {(found) => (
          <SearchResult
            search={found}
            group={view.group}
            onGroup={(group) => {
              onChange({ group });
            }}
          />
        )}
      </Loaded>
    </Stack>
  );
}
