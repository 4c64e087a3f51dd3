import { Stack } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import { searchQuery } from "../api/queries";
import { Empty } from "../components/Empty";
import { Loaded } from "../components/Loaded";
import { PageHead } from "../components/PageHead";
import { SearchForm } from "../components/SearchForm";
import { SearchResult } from "../components/SearchResult";
import type { SearchView } from "../views";

const route = getRouteApi("/search");

/** Which terms of a model the data ask for: proposed by evidence, decided by the team. */
export function SearchPage() {
  const view = route.useSearch();
  const navigate = route.useNavigate();
  const change = (part: Partial<SearchView>) =>
    void navigate({ search: (previous) => ({ ...previous, ...part }) });
  return (
    <>
      <PageHead
        title="Search for structure"
        trail={[
          <Link to="/model-structures" className="link" key="structures">
            Structures
          </Link>,
        ]}
      />
      <div className="split split-early">
        <SearchForm view={view} onChange={change} />
        {view.id === undefined ? (
          <div className="panel">
            <Empty title="No search shown">
              Choose maneuvers and modes and start a search, or open an earlier one. Equation error
              chooses the terms of each coefficient; output error and frequency response error fit
              whole models, take terms out by Wald’s test and in by the score.
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
