import { useConversion } from "../../api/units";
import { proposalDifferences, type StoredProposal } from "../../lib/drafts/proposal";
import { DataTable } from "../controls/DataTable";

interface Props {
  before: StoredProposal;
  after: StoredProposal;
  names: [string, string];
}

/** What differs between two proposals, part by part. */
export function ProposalDifference({ before, after, names }: Props) {
  const convert = useConversion();
  return (
    <DataTable
      label={`${names[0]} and ${names[1]}`}
      columns={[
        { key: "what", header: "Item", render: (one) => one.what },
        { key: "before", header: names[0], render: (one) => one.before },
        { key: "after", header: names[1], render: (one) => one.after },
      ]}
      rows={proposalDifferences(before, after, convert)}
      rowKey={(one) => one.part}
    />
  );
}
