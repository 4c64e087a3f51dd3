// Written by `npm run generate` from the API itself; do not edit.

export interface paths {
    "/api/v1/health": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Health
         * @description Ask server, database, dispatcher and workers whether they work.
         *
         *     The status is `degraded` where runs would wait for ever, or the clock is wrong: this server
         *     answers all the same (200), and another one would be no better. Where the database does
         *     not answer, nothing can be served (503).
         */
        get: operations["get_health"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/aircraft": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Aircraft
         * @description List all aircraft.
         */
        get: operations["list_aircraft"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/aircraft/{aircraft_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Aircraft
         * @description Return one aircraft.
         */
        get: operations["get_aircraft"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/aircraft/{aircraft_id}/thrust": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        /**
         * Set Thrust
         * @description Give an aircraft the thrust table that new maneuvers take their thrust from.
         */
        put: operations["set_thrust"];
        post?: never;
        /**
         * Remove Thrust
         * @description Take the thrust table of an aircraft away; maneuvers keep the thrust that they have.
         */
        delete: operations["remove_thrust"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/flights": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Flights
         * @description List flights, of one aircraft or of all.
         */
        get: operations["list_flights"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/flights/{flight_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Flight
         * @description Return one flight.
         */
        get: operations["get_flight"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/flights/{flight_id}/channels": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Flight Channels
         * @description List the channels of a whole flight, from which maneuvers are cut.
         */
        get: operations["list_flight_channels"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/flights/{flight_id}/found-maneuvers": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Find Maneuvers
         * @description Look for maneuvers in the recording of a flight; nothing is cut yet.
         */
        get: operations["find_maneuvers"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/flights/{flight_id}/maneuvers": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Cut Maneuver
         * @description Cut a maneuver out of a window of the recording, which stays as it is.
         */
        post: operations["cut_maneuver"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/ground-tests": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Ground Tests
         * @description Compare the records before and after every flight that has both.
         */
        get: operations["list_ground_tests"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/ground-tests/{flight_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Ground Test
         * @description Compare the records before and after one flight.
         */
        get: operations["get_ground_test"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/maneuvers": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Maneuvers
         * @description List maneuvers with their condition and the newest run of each method.
         */
        get: operations["list_maneuvers"];
        put?: never;
        /**
         * Upload Maneuver
         * @description Import a maneuver from files; all of it is kept, or nothing.
         */
        post: operations["upload_maneuver"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/maneuvers/facets": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Maneuver Facets
         * @description Count the list, and what each choice of a filter would leave of it.
         */
        get: operations["list_maneuver_facets"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/maneuvers/changes": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Change Maneuvers
         * @description Delete, restore, tag or untag many maneuvers; all of them, or none.
         *
         *     The answer names those that were changed: the opposite action on these is the way back.
         */
        post: operations["change_maneuvers"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/maneuvers/{maneuver_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Maneuver
         * @description Return one maneuver with its channels.
         */
        get: operations["get_maneuver"];
        put?: never;
        post?: never;
        /**
         * Delete Maneuver
         * @description Delete a maneuver with its runs; it leaves the lists and can be restored.
         */
        delete: operations["delete_maneuver"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/maneuvers/{maneuver_id}/run-proposal": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Run Proposal
         * @description Propose modes, inputs, outputs and band of a run, with what they ask of the data.
         *
         *     A run that is requested without a structure takes this proposal.
         */
        get: operations["get_run_proposal"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/maneuvers/{maneuver_id}/quality": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Quality
         * @description Return what was found about a maneuver; looked at now if it never was.
         */
        get: operations["get_quality"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/maneuvers/{maneuver_id}/conditioning": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Conditioning
         * @description List the corrections of a maneuver, those that were undone too.
         */
        get: operations["list_conditioning"];
        put?: never;
        /**
         * Take Conditioning
         * @description Take corrections, all or none; what was recorded is not changed.
         */
        post: operations["take_conditioning"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/maneuvers/{maneuver_id}/conditioning/{step_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        post?: never;
        /**
         * Undo Conditioning
         * @description Undo a correction; that it was there stays in the record.
         */
        delete: operations["undo_conditioning"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/quality": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Qualities
         * @description List maneuvers with their verdict, the worst first; nothing is computed here.
         */
        get: operations["list_qualities"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/quality/assess": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Assess Maneuvers
         * @description Begin to look at maneuvers: at these, or at all that nobody has looked at.
         */
        post: operations["assess_maneuvers"];
        /**
         * Stop Assessing
         * @description Leave the maneuvers that were not looked at yet for another time.
         */
        delete: operations["stop_assessing"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/mappings": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Mappings
         * @description List the kept mappings.
         */
        get: operations["list_mappings"];
        put?: never;
        /**
         * Add Mapping
         * @description Keep a mapping under a name; one of the same name is replaced.
         */
        post: operations["add_mapping"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/mappings/{mapping_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Mapping
         * @description Return one mapping.
         */
        get: operations["get_mapping"];
        put?: never;
        post?: never;
        /**
         * Delete Mapping
         * @description Forget a mapping; what was imported through it stays.
         */
        delete: operations["delete_mapping"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/uploads": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Imports
         * @description List the uploads that are being imported, or wait for it.
         */
        get: operations["list_imports"];
        put?: never;
        /**
         * Upload Files
         * @description Read files and propose a mapping for them; nothing is stored yet.
         */
        post: operations["upload_files"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/uploads/{upload_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Upload
         * @description Return what the files of an upload hold and the mapping proposed for them.
         */
        get: operations["get_upload"];
        put?: never;
        post?: never;
        /**
         * Delete Upload
         * @description Cancel an import, or forget the files; what was imported stays.
         */
        delete: operations["delete_upload"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/uploads/{upload_id}/state": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Upload State
         * @description Return how far an import has come.
         */
        get: operations["get_upload_state"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/uploads/{upload_id}/check": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Check Upload
         * @description Say what a mapping makes of the files; nothing is stored.
         */
        post: operations["check_upload"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/uploads/{upload_id}/preview": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Preview Upload
         * @description Draw channels as a mapping makes them.
         */
        post: operations["preview_upload"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/uploads/{upload_id}/import": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Import Upload
         * @description Begin to import the files through a mapping, all of them or nothing.
         */
        post: operations["import_upload"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/modal-tables": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Modal Tables
         * @description List modal tables; versions of one name stand side by side.
         */
        get: operations["list_modal_tables"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/modal-tables/order": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Model Order
         * @description Reduce the predicted model to every order at a condition, and say how many modes it needs.
         */
        get: operations["get_model_order"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/modal-tables/{modal_table_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Modal Table
         * @description Return one modal table with its numbers, in the order of its source.
         */
        get: operations["get_modal_table"];
        put?: never;
        post?: never;
        /**
         * Delete Modal Table
         * @description Forget a modal table; refused while runs refer to it.
         */
        delete: operations["delete_modal_table"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/modal-tables/{modal_table_id}/modes": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Modes
         * @description List the modes at a fuel fraction, followed over fuel by their shapes.
         */
        get: operations["list_modes"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/modal-tables/{modal_table_id}/shape": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Shape
         * @description Return one mode at a fuel fraction, thinned to what can be seen, with the sensors in it.
         */
        get: operations["get_shape"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/modal-tables/{modal_table_id}/correlation": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Correlation
         * @description Compare two sources: modes paired by MAC, frequency, damping, and COMAC by point.
         */
        get: operations["get_correlation"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/modal-tables/{modal_table_id}/observability": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Observability
         * @description Say which sensor sees which mode, and where a further accelerometer would help most.
         */
        get: operations["get_observability"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/modal-tables/{modal_table_id}/file": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Download Modes
         * @description Write the modes at one fuel weight as a universal file or as CSV, in SI.
         */
        get: operations["download_modes"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/modal-tables/{modal_table_id}/corrections": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Correct Mode
         * @description Name a mode otherwise than the rule does; the reason is kept.
         */
        post: operations["correct_mode"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/uploads/{upload_id}/structure": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Look At Upload
         * @description Say what modes the files of an upload hold, and what they leave open.
         */
        get: operations["look_at_upload"];
        put?: never;
        /**
         * Import Structure
         * @description Keep the modes of uploaded files as a modal table, a version beside others of its name.
         */
        post: operations["import_structure"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/uploads/{upload_id}/flutter-summary": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Import Flutter Summary
         * @description Keep the flutter summary of an uploaded printout, with the speeds found from it.
         */
        post: operations["import_flutter_summary"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/flutter-summaries": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Flutter Summaries
         * @description List the flutter summaries of an aircraft or of all.
         */
        get: operations["list_flutter_summaries"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/flutter-summaries/{summary_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Flutter Summary
         * @description Return one flutter summary.
         */
        get: operations["get_flutter_summary"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/uploads/{upload_id}/responses": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Import Responses
         * @description Keep the frequency responses of uploaded files.
         */
        post: operations["import_responses"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/measured-responses": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Measured Responses
         * @description List the measured responses of an aircraft or of all.
         */
        get: operations["list_measured_responses"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/measured-responses/{responses_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Measured Responses
         * @description Return one set of measured responses.
         */
        get: operations["get_measured_responses"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/measured-responses/{responses_id}/modes": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Find Modes
         * @description Find the modes in measured responses that are stable over the orders of models.
         */
        get: operations["find_modes"];
        put?: never;
        /**
         * Keep Found Modes
         * @description Keep the modes found as a table of a GVT, named like those of another table.
         */
        post: operations["keep_found_modes"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/uploads/{upload_id}/orthogonality": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Check Orthogonality
         * @description Check the shapes of a table over a mass matrix in an uploaded file.
         */
        post: operations["check_orthogonality"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/predictions": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Predictions
         * @description List predictions, of one aircraft or of all.
         */
        get: operations["list_predictions"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/predictions/{prediction_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Prediction
         * @description Return one prediction with its derivatives at a fuel fraction.
         */
        get: operations["get_prediction"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/model-structures": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Model Structures
         * @description List model structures in their newest version, of one aircraft or of all.
         */
        get: operations["list_model_structures"];
        put?: never;
        /**
         * Add Model Structure
         * @description Keep a model structure under a name.
         */
        post: operations["add_model_structure"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/model-structures/{structure_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Model Structure
         * @description Return the newest version of one model structure; ``ETag`` names it.
         */
        get: operations["get_model_structure"];
        /**
         * Edit Model Structure
         * @description Keep a new version; refused with both versions where another came first.
         */
        put: operations["edit_model_structure"];
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/model-structures/{structure_id}/versions": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Structure Versions
         * @description List every version of one model structure, oldest first.
         */
        get: operations["list_structure_versions"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/model-structures/{structure_id}/versions/{version}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Structure Version
         * @description Return one version of one model structure.
         */
        get: operations["get_structure_version"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/decisions": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Decisions
         * @description List decisions, newest first.
         */
        get: operations["list_decisions"];
        put?: never;
        /**
         * Propose Decision
         * @description Propose a model structure, or a change to one, for a range of conditions.
         */
        post: operations["propose_decision"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/decisions/audit": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Campaign Audit
         * @description Return the whole story of the decisions of a campaign.
         */
        get: operations["get_campaign_audit"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/decisions/{decision_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Decision
         * @description Return one decision with all that was said of it.
         */
        get: operations["get_decision"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/decisions/{decision_id}/revisions": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Revise Decision
         * @description Put another proposal in the place of one that is open; votes begin anew.
         */
        post: operations["revise_decision"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/decisions/{decision_id}/comments": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Comment Decision
         * @description Say something of a decision as a whole, or of one derivative.
         */
        post: operations["comment_decision"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/decisions/{decision_id}/votes": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Vote On Decision
         * @description Approve, reject or ask for changes; the quorum decides.
         */
        post: operations["vote_on_decision"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/decisions/{decision_id}/withdrawal": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Withdraw Decision
         * @description Take a proposal of one's own back.
         */
        post: operations["withdraw_decision"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/decisions/{decision_id}/audit": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Decision Audit
         * @description Return the whole story of one decision.
         */
        get: operations["get_decision_audit"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/review-rules/{aircraft_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Review Rules
         * @description Return the rules of review of a campaign, and what they were.
         */
        get: operations["get_review_rules"];
        /**
         * Change Review Rules
         * @description Change the rules of review of a campaign; the ones before stay readable.
         */
        put: operations["change_review_rules"];
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/baselines": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Campaign Baselines
         * @description List the approved structures of a campaign, the one approved last first.
         */
        get: operations["list_campaign_baselines"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/maneuver-baselines": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Maneuver Baselines
         * @description Tell for each maneuver which approved structure its runs take by default.
         */
        get: operations["list_maneuver_baselines"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/frozen-figures": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Freeze Figure
         * @description Keep a figure as it is now, whatever becomes of the data behind it.
         */
        post: operations["freeze_figure"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/frozen-figures/{figure_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Frozen Figure
         * @description Return what is known of a frozen figure; ``figures/frozen`` shows it.
         */
        get: operations["get_frozen_figure"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/notifications": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Notifications
         * @description Tell an analyst what waits for them, and what changed since they looked.
         */
        get: operations["get_notifications"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/notifications/seen": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Mark Notifications Seen
         * @description Note that an analyst has seen everything there is now.
         */
        post: operations["mark_notifications_seen"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/decisions/{decision_id}/seen": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Mark Decision Seen
         * @description Note that an analyst has seen a decision as it stands.
         */
        post: operations["mark_decision_seen"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/model-structures/{structure_id}/seen": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Mark Structure Seen
         * @description Note that an analyst has seen the newest version of a model structure.
         */
        post: operations["mark_structure_seen"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/runs": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Runs
         * @description List runs with their key figures; `GET /runs/{run_id}` has the rest of each.
         */
        get: operations["list_runs"];
        put?: never;
        /**
         * Request Run
         * @description Queue an estimation run; follow it at the answer's ``Location``.
         *
         *     Without a structure it takes what `GET /maneuvers/{maneuver_id}/run-proposal` proposes: the
         *     structure that was approved for the condition, else the saved one of this FTA, else the modes
         *     in the excited band; `proposal` of the run records which. What cannot be estimated (an unknown
         *     mode, input or output) is refused at once. A run with the same inputs as one that waits, runs
         *     or succeeded is that run (200, ``repeated``).
         */
        post: operations["request_run"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/runs/facets": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Run Facets
         * @description Count the list, and what each choice of a filter would leave of it.
         */
        get: operations["list_run_facets"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/runs/changes": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Change Runs
         * @description Delete, restore, tag or untag many runs; all of them, or none.
         *
         *     The answer names those that were changed: the opposite action on these is the way back.
         */
        post: operations["change_runs"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/runs/{run_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Run
         * @description Return one run; its parameters once it succeeded.
         */
        get: operations["get_run"];
        put?: never;
        post?: never;
        /**
         * Delete Run
         * @description Delete a run that has ended; it leaves the lists and can be restored.
         */
        delete: operations["delete_run"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/runs/{run_id}/export": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Run Export
         * @description Return everything a run rests on and gave, with covariance and fitted lines.
         */
        get: operations["get_run_export"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/runs/{run_id}/model": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Run Model
         * @description Return the identified model as matrices with names and units.
         */
        get: operations["get_run_model"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/saved-views": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Saved Views
         * @description List saved views, of one page or of all.
         */
        get: operations["list_saved_views"];
        put?: never;
        /**
         * Add Saved View
         * @description Keep what a page shows under a name; one of the same name is not replaced.
         */
        post: operations["add_saved_view"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/saved-views/{view_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        post?: never;
        /**
         * Delete Saved View
         * @description Forget a saved view.
         */
        delete: operations["delete_saved_view"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/searches": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Searches
         * @description List searches, newest first.
         */
        get: operations["list_searches"];
        put?: never;
        /**
         * Request Search
         * @description Queue a search for the terms of a model; follow it at the answer's ``Location``.
         */
        post: operations["request_search"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/searches/{search_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Search
         * @description Return one search: how far it is, or all that it found.
         */
        get: operations["get_search"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/searches/{search_id}/cancel": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Cancel Search
         * @description Stop a search that has not ended.
         */
        post: operations["cancel_search"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/searches/{search_id}/candidates/{place}/run": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Open Candidate
         * @description Open a candidate as a run; it is queued when first opened, and the same ever after.
         */
        post: operations["open_candidate"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/jobs": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Jobs
         * @description List jobs, newest first.
         */
        get: operations["list_jobs"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/jobs/status": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Queue Status
         * @description Tell how the queue goes and who works.
         */
        get: operations["get_queue_status"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/jobs/{job_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Job
         * @description Tell how far a job is.
         */
        get: operations["get_job"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/jobs/{job_id}/log": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Job Log
         * @description Tell what happened to a job so far.
         */
        get: operations["get_job_log"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/jobs/{job_id}/cancel": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Cancel Job
         * @description Stop a job that has not ended.
         */
        post: operations["cancel_job"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/jobs/{job_id}/retry": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Retry Job
         * @description Queue a job again that failed or was cancelled.
         */
        post: operations["retry_job"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/events": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Stream Events
         * @description Stream what happens to runs, as server-sent events.
         *
         *     `run` is a line of a log, with its id; `running` lists the jobs under way; `missed`
         *     says that more happened meanwhile than is told: read the lists again. A browser that
         *     connects again goes on by itself; others give the id of the last event they know.
         */
        get: operations["stream_events"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/batches": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Batches
         * @description List batches with their progress, newest first.
         */
        get: operations["list_batches"];
        put?: never;
        /**
         * Request Batch
         * @description Queue many runs; all of them, or none.
         *
         *     Without structures each maneuver takes what is proposed for it, as single runs do.
         */
        post: operations["request_batch"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/batches/{batch_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Batch
         * @description Tell how far a batch is.
         */
        get: operations["get_batch"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/batches/{batch_id}/cancel": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Cancel Batch
         * @description Cancel what has not ended of a batch; runs that another batch also wants go on.
         */
        post: operations["cancel_batch"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/batches/{batch_id}/retry": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Retry Batch
         * @description Queue again what failed or was cancelled of a batch.
         */
        post: operations["retry_batch"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/comparisons": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Comparison
         * @description Compare derivatives of runs and predictions, pair by pair too, and what differs in them.
         */
        get: operations["get_comparison"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/comparisons/trend": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Trend
         * @description Lay one derivative out over the conditions that were flown, with a fit per method.
         */
        get: operations["get_trend"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/reports/run/{run_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Report Run
         * @description Report a run: structure, derivatives, fit, uncertainty, poles and provenance.
         */
        get: operations["report_run"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/reports/comparison": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Report Comparison
         * @description Report how runs and predictions agree, derivative by derivative.
         */
        get: operations["report_comparison"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/reports/decision/{decision_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Report Decision
         * @description Report a decision: range, structure, evidence, votes and history.
         */
        get: operations["report_decision"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/reports/campaign": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Report Campaign
         * @description Report the maneuvers that a list is narrowed to, and the ground tests around them.
         */
        get: operations["report_campaign"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/designs": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Designs
         * @description List excitation designs.
         */
        get: operations["list_designs"];
        put?: never;
        /**
         * Create Design
         * @description Search the phases of a design and keep it; a few seconds.
         */
        post: operations["create_design"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/designs/searches": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Search Design
         * @description Begin to search the phases of a design, as a task that can be followed and cancelled.
         */
        post: operations["search_design"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/designs/flown": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Import Flown
         * @description Recognise multisines that were flown and keep them as they were.
         */
        post: operations["import_flown"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/designs/catalogue": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Catalogue
         * @description List the 24 designs of Table 1.
         */
        get: operations["list_catalogue"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/designs/{design_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Design
         * @description Return one design.
         */
        get: operations["get_design"];
        put?: never;
        post?: never;
        /**
         * Delete Design
         * @description Forget a design.
         */
        delete: operations["delete_design"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/designs/{design_id}/checks": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Check Design
         * @description Check orthogonality, peaks, and what moves behind an actuator.
         *
         *     Limits: position [rad], rate [rad/s], acceleration [rad/s2].
         */
        get: operations["check_design"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/designs/{design_id}/target-modes": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Target Modes
         * @description Compare the band of a design with the structural modes that it targets on an aircraft.
         */
        get: operations["get_target_modes"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/designs/{design_id}/expected-errors": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Expect Errors
         * @description Predict the standard errors of a run's derivatives, had this design been flown.
         */
        get: operations["expect_errors"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/designs/{design_id}/expected-response": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Expect Response
         * @description Tell how far modes stand out of the noise, and how surfaces would be correlated.
         */
        get: operations["expect_response"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/designs/{design_id}/classic-inputs": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Compare Classic Inputs
         * @description Compare a design with doublets, 3-2-1-1s and sweeps that keep its limits; seconds.
         */
        get: operations["compare_classic_inputs"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/designs/{design_id}/allocation": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Allocate Amplitudes
         * @description Find amplitudes with the least worst relative standard error, and D-optimal ones.
         *
         *     Limits: largest deflection of any surface [rad] and load factor [g], feedback
         *     included; the design's own where left out.
         */
        get: operations["allocate_amplitudes"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/designs/{design_id}/rescaled": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Rescale Design
         * @description Keep a design with the same lines and phases and other amplitudes.
         */
        post: operations["rescale_design"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/designs/{design_id}/redesign": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Redesign
         * @description Begin to search phases anew for the lines of a design, as one that was flown.
         */
        post: operations["redesign"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/designs/{design_id}/rehearsals": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Rehearsals
         * @description List the rehearsals of a design, newest first, with what their runs estimated.
         */
        get: operations["list_rehearsals"];
        put?: never;
        /**
         * Rehearse
         * @description Begin to fly a design in simulation; the maneuver is kept and its estimation queued.
         */
        post: operations["rehearse"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/designs/{design_id}/export": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Export Design
         * @description Return one period at the flight computer's rate, or the recipe.
         */
        get: operations["export_design"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/controllers": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Controllers
         * @description List controllers, of one aircraft or all.
         */
        get: operations["list_controllers"];
        put?: never;
        /**
         * Create Controller
         * @description Keep a controller given as text.
         */
        post: operations["create_controller"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/controllers/files": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Upload Controller
         * @description Keep a controller of a file.
         */
        post: operations["upload_controller"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/controllers/{controller_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Controller
         * @description Return one controller.
         */
        get: operations["get_controller"];
        put?: never;
        post?: never;
        /**
         * Delete Controller
         * @description Forget a controller that no rehearsal was flown with.
         */
        delete: operations["delete_controller"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/flutter/answers": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Find Flutter
         * @description Begin to find the answer and its figures for many runs; then they are there at once.
         */
        post: operations["find_flutter"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/flutter": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Flutter
         * @description Say where the aircraft of these runs loses stability, and how sure that is.
         */
        get: operations["get_flutter"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/closed-loop/answers": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Find Closed Loop
         * @description Begin to find the answer for many runs; then it is there at once.
         */
        post: operations["find_closed_loop"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/closed-loop": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Closed Loop
         * @description Say how far a controller's loop around the identified aircraft is from instability.
         */
        get: operations["get_closed_loop"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/tasks": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Tasks
         * @description List what is under way beside the runs and what has ended lately, newest first.
         */
        get: operations["list_tasks"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/tasks/{task_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Task
         * @description Return how far a task is.
         */
        get: operations["get_task"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/tasks/{task_id}/cancel": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Cancel Task
         * @description Ask a task to stop; nothing of it is kept.
         */
        post: operations["cancel_task"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/envelope": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Envelope
         * @description Draw where the maneuvers of a list were flown.
         */
        get: operations["draw_envelope"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/time-history": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Time History
         * @description Draw channels against time, thinned to what a screen shows; inputs by default.
         *
         *     Files hold every sample of the window.
         */
        get: operations["draw_time_history"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/flight-history": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Flight History
         * @description Draw channels of a whole flight against time; the commands by default.
         */
        get: operations["draw_flight_history"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/spectrum": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Spectrum
         * @description Draw Fourier magnitudes at the excited lines, coloured by owner; inputs by default.
         */
        get: operations["draw_spectrum"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/signal-to-noise": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Signal To Noise
         * @description Draw signal over noise per channel and line; all inputs and outputs by default.
         */
        get: operations["draw_signal_to_noise"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/plot-matrix": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Plot Matrix
         * @description Draw channels against each other with their correlation; inputs by default.
         */
        get: operations["draw_plot_matrix"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/bode": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Bode
         * @description Draw frequency responses, with the models of runs over them.
         */
        get: operations["draw_bode"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/reconstruction": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Reconstruction
         * @description Draw motion and coefficients that all sensors together tell, with ±2 standard errors.
         *
         *     In time from the smoother (Fig. 16a), in frequency line by line with rank and condition.
         */
        get: operations["draw_reconstruction"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/loops": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Loops
         * @description Draw each surface's loop as flown, with its margins.
         */
        get: operations["draw_loops"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/ground-test": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Ground Test
         * @description Draw spectra on the runway before and after a flight.
         */
        get: operations["draw_ground_test"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/fit": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Fit
         * @description Draw fitted over measured lines.
         */
        get: operations["draw_fit"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/residual": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Residual
         * @description Draw what the model left over, per output and frequency.
         */
        get: operations["draw_residual"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/parameter-correlation": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Parameter Correlation
         * @description Draw how the estimates depend on each other.
         */
        get: operations["draw_parameter_correlation"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/poles": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Poles
         * @description Draw the poles of identified models beside those of the first one's modes in vacuo.
         */
        get: operations["draw_poles"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/iterations": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Iterations
         * @description Draw how the cost fell.
         */
        get: operations["draw_iterations"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/time-check": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Time Check
         * @description Draw recorded outputs and what the identified model makes of the recorded inputs.
         */
        get: operations["draw_time_check"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/derivatives": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Derivatives
         * @description Draw derivatives by method and prediction with ±2 standard errors.
         */
        get: operations["draw_derivatives"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/forest": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Forest
         * @description Draw what each run and prediction says about one derivative, over their mean.
         */
        get: operations["draw_forest"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/trend": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Trend
         * @description Draw one derivative over the conditions that were flown, with weighted fits.
         */
        get: operations["draw_trend"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/v-omega-zeta": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw V Omega Zeta
         * @description Draw frequency and damping of the identified roots with ±2 standard errors.
         */
        get: operations["draw_v_omega_zeta"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/root-locus": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Root Locus
         * @description Draw the identified roots in the s-plane.
         */
        get: operations["draw_root_locus"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/equivalent-modes": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Equivalent Modes
         * @description Draw equivalent frequency and damping of every run over dynamic pressure (Eq. 25).
         */
        get: operations["draw_equivalent_modes"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/flutter-forecast": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Flutter Forecast
         * @description Draw the flutter speed each run predicts, classical trackers beside it.
         */
        get: operations["draw_flutter_forecast"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/flutter-map": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Flutter Map
         * @description Draw the flutter speed over fuel and altitude.
         */
        get: operations["draw_flutter_map"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/closed-loop-margins": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Closed Loop Margins
         * @description Draw margins of every surface's loop over airspeed.
         */
        get: operations["draw_closed_loop_margins"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/closed-loop-roots": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Closed Loop Roots
         * @description Draw roots with and without a controller.
         */
        get: operations["draw_closed_loop_roots"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/search-path": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Search Path
         * @description Draw the criteria after every step of a search for structure.
         */
        get: operations["draw_search_path"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/search-stability": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Search Stability
         * @description Draw how often each term is chosen when the lines are drawn anew.
         */
        get: operations["draw_search_stability"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/design-history": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Design History
         * @description Draw one period of a designed excitation.
         */
        get: operations["draw_design_history"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/design-spectrum": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Design Spectrum
         * @description Draw the lines of a designed excitation by the input that owns them.
         */
        get: operations["draw_design_spectrum"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/design-worth": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Design Worth
         * @description Draw what each line of a design is worth for the parameters of a run.
         */
        get: operations["draw_design_worth"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/design-signal": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Design Signal
         * @description Draw each output's expected signal over noise at each line of a design.
         */
        get: operations["draw_design_signal"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/frozen": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Frozen
         * @description Draw a figure as it was when it was frozen for a decision.
         */
        get: operations["draw_frozen"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/modes-against-fuel": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Modes Against Fuel
         * @description Draw frequency and damping of the modes of a table over fuel, crossings marked.
         */
        get: operations["draw_modes_against_fuel"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/mac": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Assurance
         * @description Draw the MAC of a table's modes with themselves, another fuel weight, or another table.
         */
        get: operations["draw_assurance"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/model-order": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Model Order
         * @description Draw derivatives against the number of modes kept, with the band of ±10 %.
         */
        get: operations["draw_model_order"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/reduced-responses": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Reduced Responses
         * @description Draw one response of the full and the reduced models, and to sensors of a rigid body.
         */
        get: operations["draw_reduced_responses"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/stabilisation": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Stabilisation
         * @description Draw the poles of models of every order over the mean measured response.
         */
        get: operations["draw_stabilisation"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/nomenclature": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Nomenclature
         * @description List every quantity with its unit and meaning, or describe names by what they follow.
         */
        get: operations["list_nomenclature"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
}
export type webhooks = Record<string, never>;
export interface components {
    schemas: {
        /**
         * Action
         * @description What can be done to many; each is undone by its neighbour, on what it changed.
         * @enum {string}
         */
        Action: "delete" | "restore" | "tag" | "untag";
        /**
         * Against
         * @description What a derivative is drawn over.
         * @enum {string}
         */
        Against: "dynamic_pressure" | "airspeed_ratio" | "fuel" | "fta";
        /**
         * Aircraft
         * @description Everything about one airframe that does not change from maneuver to maneuver.
         */
        Aircraft: {
            /** Name */
            name: string;
            geometry: components["schemas"]["Geometry"];
            mass: components["schemas"]["MassTable"];
            /** Surfaces */
            surfaces: components["schemas"]["Surface"][];
            /** Sensors */
            sensors: components["schemas"]["Sensor"][];
            /**
             * Combinations
             * @default []
             */
            combinations: components["schemas"]["Combination"][];
            /** Instruments */
            instruments: {
                [key: string]: components["schemas"]["Instrument"];
            };
            polar?: components["schemas"]["DragPolar"] | null;
            flutter?: components["schemas"]["FlutterTable"] | null;
            thrust?: components["schemas"]["ThrustTable"] | null;
            /**
             * Description
             * @default
             */
            description: string;
            /** Id */
            id?: number | null;
        };
        /**
         * AircraftList
         * @description Aircraft.
         */
        AircraftList: {
            /** Items */
            items: components["schemas"]["Aircraft"][];
            /** Next */
            next?: string | null;
        };
        /**
         * Algorithm
         * @description How equation error chooses.
         * @enum {string}
         */
        Algorithm: "stepwise" | "orthogonal functions";
        /**
         * AllocatedError
         * @description Relative standard error of a derivative under the three; ``counts`` for the worst. [1]
         */
        AllocatedError: {
            /** Name */
            name: string;
            /** Value */
            value: number;
            /** Counts */
            counts: boolean;
            /** Flat */
            flat: number;
            /** Minimax */
            minimax: number;
            /** D Optimal */
            d_optimal: number;
        };
        /**
         * AllocatedPeak
         * @description Largest of a command or of what is limited: as designed, minimax and D-optimal.
         *
         *     [unit of the command] or [g]
         */
        AllocatedPeak: {
            /** Name */
            name: string;
            /** Limit */
            limit: number | null;
            /** Flat */
            flat: number;
            /** Minimax */
            minimax: number;
            /** D Optimal */
            d_optimal: number;
        };
        /**
         * Allocation
         * @description ``gains`` of the inputs by criterion, peaks of commands and of what is limited.
         */
        Allocation: {
            /** Gains */
            gains: {
                [key: string]: {
                    [key: string]: number;
                };
            };
            /** Commands */
            commands: components["schemas"]["AllocatedPeak"][];
            /** Limited */
            limited: components["schemas"]["AllocatedPeak"][];
            /** Errors */
            errors: components["schemas"]["AllocatedError"][];
            /** Next */
            next?: string | null;
        };
        /**
         * Along
         * @description What roots are followed along.
         * @enum {string}
         */
        Along: "airspeed" | "dynamic_pressure" | "fuel";
        /**
         * AssessRequest
         * @description Maneuvers to look at; all that nobody has looked at where none is named.
         */
        AssessRequest: {
            /** Maneuver Ids */
            maneuver_ids?: number[] | null;
        };
        /**
         * Assessing
         * @description How far the assessment of a campaign is.
         */
        Assessing: {
            /** Running */
            running: boolean;
            /** Done */
            done: number;
            /** Total */
            total: number;
            /** Failed */
            failed: number;
        };
        /**
         * AuditTrail
         * @description Decisions of a campaign with its rules and baselines, as they stood at ``exported_at``.
         */
        AuditTrail: {
            aircraft: components["schemas"]["Aircraft"];
            /**
             * Exported At
             * Format: date-time
             */
            exported_at: string;
            /** Software */
            software: {
                [key: string]: string;
            };
            /** Check */
            check: string;
            /** Rules */
            rules: components["schemas"]["ReviewRules"][];
            /** Baselines */
            baselines: components["schemas"]["Baseline"][];
            /** Decisions */
            decisions: components["schemas"]["AuditedDecision"][];
        };
        /**
         * AuditedDecision
         * @description A decision with its events and all that they point to.
         *
         *     ``whole`` tells that no event was changed or taken out and that the events lead to
         *     where the decision stands; ``changed_since`` names what it rests on that is not any
         *     more what it was at the last event (or is gone).
         */
        AuditedDecision: {
            decision: components["schemas"]["Decision"];
            /** Events */
            events: components["schemas"]["DecisionEvent"][];
            /** Whole */
            whole: boolean;
            /** Changed Since */
            changed_since: string[];
            /** Structures */
            structures: components["schemas"]["StructureVersion"][];
            /** Runs */
            runs: components["schemas"]["AuditedRun"][];
            /** Figures */
            figures: components["schemas"]["AuditedFigure"][];
        };
        /**
         * AuditedFigure
         * @description A frozen figure with what it shows.
         */
        AuditedFigure: {
            figure: components["schemas"]["FrozenFigure"];
            /** Spec */
            spec: {
                [key: string]: unknown;
            };
        };
        /**
         * AuditedRun
         * @description What a linked run was and gave, in short.
         */
        AuditedRun: {
            /** Id */
            id: number;
            /** Maneuver Id */
            maneuver_id: number;
            /** Maneuver Label */
            maneuver_label: string;
            /** Method */
            method: string;
            /** Author */
            author: string;
            /** Created At */
            created_at: string | null;
            /** Structure Id */
            structure_id: number | null;
            /** Structure Version */
            structure_version: number | null;
            /** Outcome */
            outcome: string | null;
            /** R Squared */
            r_squared: {
                [key: string]: number;
            };
            /** Parameters */
            parameters: components["schemas"]["ParameterEstimate"][];
            /** Versions */
            versions: {
                [key: string]: string;
            } | null;
        };
        /**
         * Average
         * @description A condition channel over the maneuver; ``drift`` is its trend from start to end.
         */
        Average: {
            /** Name */
            name: string;
            /** Unit */
            unit: string;
            /** Mean */
            mean: number;
            /** Std */
            std: number;
            /** Smallest */
            smallest: number;
            /** Largest */
            largest: number;
            /** Drift */
            drift: number;
        };
        /**
         * BandRequest
         * @description One input by its band: ``count`` lines, half of them about ``targets_hz`` if any.
         *
         *     ``spectrum`` gives relative power at frequencies [Hz], log-log between; flat if left out.
         */
        BandRequest: {
            /** Name */
            name: string;
            /** Low Hz */
            low_hz: number;
            /** High Hz */
            high_hz: number;
            /** Count */
            count: number;
            /**
             * Relative Peak
             * @default 1
             */
            relative_peak: number;
            /**
             * Targets Hz
             * @default []
             */
            targets_hz: number[];
            /**
             * Spectrum
             * @default []
             */
            spectrum: [
                number,
                number
            ][];
        };
        /**
         * Baseline
         * @description An approved structure, the decision behind it, and where it holds.
         */
        Baseline: {
            /** Decision Id */
            decision_id: number;
            /** Title */
            title: string;
            /** Limits */
            limits: {
                [key: string]: [
                    number,
                    number
                ];
            };
            /** Approved By */
            approved_by: string[];
            structure: components["schemas"]["StructureVersion"];
        };
        /**
         * BaselineList
         * @description Baselines of a campaign, the one approved last first.
         */
        BaselineList: {
            /** Items */
            items: components["schemas"]["Baseline"][];
        };
        /**
         * Batch
         * @description What many runs have in common: that somebody wanted them at once.
         */
        Batch: {
            /** Name */
            name: string;
            /**
             * Author
             * @default
             */
            author: string;
            /** Created At */
            created_at?: string | null;
            /** Id */
            id?: number | null;
        };
        /**
         * BatchList
         * @description A page of batches.
         */
        BatchList: {
            /** Items */
            items: components["schemas"]["BatchProgress"][];
            /** Next */
            next: string | null;
        };
        /**
         * BatchProgress
         * @description How far a batch is.
         */
        BatchProgress: {
            batch: components["schemas"]["Batch"];
            /** States */
            states: {
                [key: string]: number;
            };
            /** Started At */
            started_at: string | null;
            /** Finished At */
            finished_at: string | null;
        };
        /**
         * BatchRequest
         * @description Estimate many maneuvers, by each of the methods, with each of the structures.
         *
         *     With ``from_equation_error`` OE and FRE wait for the EE run of the same maneuver and
         *     structure, and start from it.
         */
        BatchRequest: {
            /** Name */
            name: string;
            /** Maneuver Ids */
            maneuver_ids: number[];
            /** Methods */
            methods: components["schemas"]["Method"][];
            /**
             * Structures
             * @default []
             */
            structures: components["schemas"]["BatchStructure"][];
            settings?: components["schemas"]["SettingsRequest"] | null;
            /** Modal Table Id */
            modal_table_id?: number | null;
            /** Damping Table Id */
            damping_table_id?: number | null;
            /** Prediction Id */
            prediction_id?: number | null;
            /**
             * From Equation Error
             * @default false
             */
            from_equation_error: boolean;
            /**
             * Priority
             * @default 0
             */
            priority: number;
            limits?: components["schemas"]["LimitsRequest"] | null;
        };
        /**
         * BatchStructure
         * @description A structure of a batch: in full, or a kept one, in its newest version if none is named.
         */
        BatchStructure: {
            structure?: components["schemas"]["StructureRequest"] | null;
            /** Structure Id */
            structure_id?: number | null;
            /** Structure Version */
            structure_version?: number | null;
        };
        /** Body_import_flown */
        Body_import_flown: {
            /**
             * Files
             * @description Samples of exactly one period.
             */
            files: string[];
            /** Name */
            name: string;
            /** Rate Hz */
            rate_hz: number;
            /**
             * Unit
             * @default deg
             * @enum {string}
             */
            unit: "deg" | "rad";
            /**
             * Apart
             * @description Each file is a design of its own.
             * @default false
             */
            apart: boolean;
        };
        /** Body_upload_controller */
        Body_upload_controller: {
            /**
             * File
             * @description JSON, or MATLAB with A, B, C and D.
             */
            file: string;
            /** Aircraft Id */
            aircraft_id: number;
            /** Name */
            name: string;
            /**
             * Reads
             * @description For MATLAB: signals read, by commas.
             * @default
             */
            reads: string;
            /**
             * Drives
             * @description For MATLAB: surfaces driven, by commas.
             * @default
             */
            drives: string;
        };
        /** Body_upload_files */
        Body_upload_files: {
            /**
             * Files
             * @description Recorder files of one flight.
             */
            files: string[];
        };
        /** Body_upload_maneuver */
        Body_upload_maneuver: {
            /**
             * Files
             * @description Recorder files and tables.
             */
            files: string[];
            /**
             * Mapping
             * @description TOML that names channels, units and roles; not for known forms.
             */
            mapping?: string | null;
            /**
             * Aircraft Id
             * @description Where the mapping names none.
             */
            aircraft_id?: number | null;
            /**
             * Confirmed
             * @description What the mapping, or that of a known form, guesses is right.
             * @default false
             */
            confirmed: boolean;
        };
        /**
         * Butterworth
         * @description Analog low-pass filter of given order and corner. [rad/s]
         */
        Butterworth: {
            /** Order */
            order: number;
            /** Corner */
            corner: number;
        };
        /**
         * Candidate
         * @description A place for a further accelerometer: what it would add, and whom it would help most.
         */
        Candidate: {
            /** Node */
            node: number;
            /** Axis */
            axis: string;
            /** Place M */
            place_m: [
                number,
                number,
                number
            ];
            /** Gain */
            gain: number;
            /** Helps */
            helps: string;
            /** Shrinks To */
            shrinks_to: number;
        };
        /**
         * CatalogueList
         * @description Table 1.
         */
        CatalogueList: {
            /** Items */
            items: components["schemas"]["CatalogueRow"][];
            /** Next */
            next?: string | null;
        };
        /**
         * CatalogueRow
         * @description One row of Table 1; counts are per input, ``periods`` the duration in units of T.
         */
        CatalogueRow: {
            /** Number */
            number: number;
            /** Numbers */
            numbers: [
                number,
                number,
                number
            ];
            /** Axis */
            axis: string;
            /** Periods */
            periods: number;
            /** Surfaces */
            surfaces: number;
            /** Throttles */
            throttles: number;
            /** Harmonics Per Input */
            harmonics_per_input: number;
            /** Throttle Harmonics */
            throttle_harmonics: number;
            /** Targets */
            targets: string;
            /** Inputs */
            inputs: string[];
        };
        /**
         * Change
         * @description Something that somebody else did; ``subject`` is a decision or a model structure.
         */
        Change: {
            /** Subject */
            subject: string;
            /** Id */
            id: number;
            /** Title */
            title: string;
            /** What */
            what: string;
            /** Author */
            author: string;
            /** Text */
            text: string;
            /** Number */
            number: number;
            /** At */
            at: string | null;
        };
        /**
         * ChangeRequest
         * @description Do the same to many maneuvers or runs; ``tag`` goes with ``tag`` and ``untag``.
         */
        ChangeRequest: {
            /** Ids */
            ids: number[];
            action: components["schemas"]["Action"];
            /** Tag */
            tag?: string | null;
        };
        /**
         * Changed
         * @description Which of many records an action changed.
         */
        Changed: {
            /** Ids */
            ids: number[];
        };
        /**
         * Channel
         * @description One recorded channel at its native rate, unit and precision.
         */
        Channel: {
            /** Name */
            name: string;
            /** Unit */
            unit: string;
            role: components["schemas"]["Role"];
            /** Rate Hz */
            rate_hz: number;
            /** Start S */
            start_s: number;
            /** N Samples */
            n_samples: number;
            /** Array */
            array: string;
            /** Sensor */
            sensor?: string | null;
            /** Source File */
            source_file?: string | null;
            /** Source Hash */
            source_hash?: string | null;
            /** Source Field */
            source_field?: string | null;
            /** Maneuver Id */
            maneuver_id?: number | null;
            /** Id */
            id?: number | null;
        };
        /**
         * ChannelQuality
         * @description One channel; what cannot be told is None.
         *
         *     ``signal_to_noise_db`` is the median over the lines, ``coherence`` that with what all
         *     other sensors say, ``noise_excess`` what it disagrees with them by, over its noise and one
         *     per cent of its level. ``not_checked`` is the reason why an output could not be checked
         *     against the others: nothing is concluded of its delay, scale factor and sign.
         *     ``delay_s`` counts from the reference, ``scale`` is recorded over true, ``bias`` in SI.
         *     At most fifty ``stretches`` are listed; ``n_stretches`` counts all.
         */
        ChannelQuality: {
            /** Name */
            name: string;
            /** Role */
            role: string;
            /** Unit */
            unit: string;
            /** Signal To Noise Db */
            signal_to_noise_db?: number | null;
            /** Coherence */
            coherence?: number | null;
            /** Noise Excess */
            noise_excess?: number | null;
            /** Delay S */
            delay_s?: number | null;
            /** Delay Std */
            delay_std?: number | null;
            /** Scale */
            scale?: number | null;
            /** Scale Std */
            scale_std?: number | null;
            /** Bias */
            bias?: number | null;
            /** Bias Std */
            bias_std?: number | null;
            /**
             * Bias Basis
             * @default
             */
            bias_basis: string;
            /**
             * Saturated
             * @default 0
             */
            saturated: number;
            /**
             * N Stretches
             * @default 0
             */
            n_stretches: number;
            /**
             * Stretches
             * @default []
             */
            stretches: components["schemas"]["FoundStretch"][];
            /** Not Checked */
            not_checked?: string | null;
        };
        /**
         * Checked
         * @description What a mapping makes of an upload, with questions where a unit is doubtful.
         *
         *     ``guesses`` are values that nobody has confirmed; nothing is imported before.
         *     ``rules`` are its ``[[channels]]`` as they are written, for the table of the page.
         */
        Checked: {
            /** Rules */
            rules: {
                [key: string]: unknown;
            }[];
            /** Channels */
            channels: components["schemas"]["MappedChannel"][];
            /** Questions */
            questions: components["schemas"]["Doubt"][];
            /** Guesses */
            guesses: components["schemas"]["Guess"][];
            problem: components["schemas"]["flexsid__workflow__describing__Problem"] | null;
        };
        /**
         * Choice
         * @description One choice of a filter, and the lines that it would leave beside the other filters.
         */
        Choice: {
            /** Value */
            value: string;
            /** Label */
            label: string;
            /** Count */
            count: number;
        };
        /**
         * ClosedLoopAnswer
         * @description Where the closed loop loses stability, and its margins over airspeed.
         */
        ClosedLoopAnswer: {
            /** Sentence */
            sentence: string;
            /** Controller */
            controller: string;
            /** Fuel Fraction */
            fuel_fraction: number;
            /** Density Kg M3 */
            density_kg_m3: number;
            /** Tested M S */
            tested_m_s: number;
            /** Lost M S */
            lost_m_s: number | null;
            /** Spread M S */
            spread_m_s: number;
            /** Low M S */
            low_m_s: number | null;
            /** High M S */
            high_m_s: number | null;
            /** Margins */
            margins: components["schemas"]["MarginRow"][];
        };
        /**
         * Combination
         * @description A channel made of others, e.g. ``az_ofs = 0.5 az_ofl + 0.5 az_ofr`` (Eq. 3).
         */
        Combination: {
            /** Name */
            name: string;
            /** Terms */
            terms: [
                string,
                number
            ][];
        };
        /**
         * CommentRequest
         * @description What is said of a decision as a whole, or of one derivative.
         */
        CommentRequest: {
            /** Text */
            text: string;
            /** Derivative */
            derivative?: string | null;
        };
        /**
         * ComparedInput
         * @description One way to excite: largest deflection [rad], load factor [g], energy [rad2 s].
         *
         *     ``pulse_s`` is the pulse length that told most; ``std_errors`` are empty, and ``lacking``
         *     says why, where derivatives are not told apart.
         */
        ComparedInput: {
            /** Kind */
            kind: string;
            /** Pulse S */
            pulse_s: number | null;
            /** Deflection */
            deflection: number;
            /** Load Factor */
            load_factor: number;
            /** Energy */
            energy: number;
            /** Std Errors */
            std_errors: number[];
            /**
             * Lacking
             * @default
             */
            lacking: string;
        };
        /**
         * Comparison
         * @description Rows per derivative, columns per source; the runs' verdict, and one per prediction.
         */
        Comparison: {
            /** Maneuver Ids */
            maneuver_ids: number[];
            /** Sources */
            sources: components["schemas"]["Source"][];
            /** Rows */
            rows: components["schemas"]["Row"][];
            /**
             * Pairs
             * @default []
             */
            pairs: components["schemas"]["Pair"][];
            /**
             * Setup
             * @default []
             */
            setup: components["schemas"]["Setup"][];
            /**
             * @default {
             *       "n_judged": 0,
             *       "n_consistent": 0
             *     }
             */
            runs_verdict: components["schemas"]["flexsid__records__comparison__Verdict"];
            /**
             * Prediction Verdicts
             * @default []
             */
            prediction_verdicts: components["schemas"]["flexsid__records__comparison__Verdict"][];
        };
        /**
         * ComparisonRequest
         * @description Runs and predictions to be compared, of one coefficient or all.
         */
        ComparisonRequest: {
            /** Run Ids */
            run_ids: number[];
            /**
             * Prediction Ids
             * @default []
             */
            prediction_ids: number[];
            /** Coefficient */
            coefficient?: string | null;
        };
        /**
         * Condition
         * @description Flight condition averaged over the maneuver; origin of body axes is the c.g.
         */
        Condition: {
            /** Airspeed M S */
            airspeed_m_s: number;
            /** Density Kg M3 */
            density_kg_m3: number;
            /** Fuel Fraction */
            fuel_fraction: number;
            /** Mass Kg */
            mass_kg: number;
            /** Pitch Inertia Kg M2 */
            pitch_inertia_kg_m2: number;
            /** X Cg M */
            x_cg_m: number;
            /** Z Cg M */
            z_cg_m: number;
            /**
             * Alpha Rad
             * @default 0
             */
            alpha_rad: number;
            /**
             * Gamma Rad
             * @default 0
             */
            gamma_rad: number;
            /**
             * Thrust N
             * @default 0
             */
            thrust_n: number;
            /** Flutter Speed M S */
            flutter_speed_m_s?: number | null;
        };
        /**
         * ConditioningList
         * @description Corrections of the channels of a maneuver.
         */
        ConditioningList: {
            /** Items */
            items: components["schemas"]["ConditioningStep"][];
        };
        /**
         * ConditioningRequest
         * @description Corrections to take together.
         */
        ConditioningRequest: {
            /** Items */
            items: components["schemas"]["StepRequest"][];
        };
        /**
         * ConditioningStep
         * @description A correction that was taken; a step that is undone stays in the record.
         */
        ConditioningStep: {
            /** Maneuver Id */
            maneuver_id: number;
            correction: components["schemas"]["Correction"];
            /** Channel */
            channel: string;
            /**
             * Author
             * @default
             */
            author: string;
            /** Created At */
            created_at?: string | null;
            /** Undone By */
            undone_by?: string | null;
            /** Undone At */
            undone_at?: string | null;
            /** Id */
            id?: number | null;
        };
        /**
         * ControlLaw
         * @description u = K y with the sign in K, in state-space form; SI and rad.
         */
        ControlLaw: {
            /** Airspeed M S */
            airspeed_m_s: number;
            /** A */
            A: number[][];
            /** B */
            B: number[][];
            /** C */
            C: number[][];
            /** D */
            D: number[][];
        };
        /**
         * Controller
         * @description A law reads outputs and drives surfaces by their names; linear between airspeeds.
         */
        Controller: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Name */
            name: string;
            /** Reads */
            reads: string[];
            /** Drives */
            drives: string[];
            /** Laws */
            laws: components["schemas"]["ControlLaw"][];
            /**
             * Delay S
             * @default 0
             */
            delay_s: number;
            /**
             * Note
             * @default
             */
            note: string;
            /** Created At */
            created_at?: string | null;
            /** Id */
            id?: number | null;
        };
        /**
         * ControllerList
         * @description Controllers, oldest first.
         */
        ControllerList: {
            /** Items */
            items: components["schemas"]["Controller"][];
            /** Next */
            next?: string | null;
        };
        /**
         * ControllerRequest
         * @description A controller as JSON text: ``reads``, ``drives``, and matrices or transfer functions.
         */
        ControllerRequest: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Name */
            name: string;
            /** Text */
            text: string;
        };
        /**
         * Correction
         * @description One correction of one channel; what does not belong to its kind stays as it is.
         *
         *     ``stretches`` are the first sample and the sample after the last of each repair.
         *     ``std`` is the standard error of the delay [s] or of the scale factor [1].
         */
        Correction: {
            /** Channel */
            channel: string;
            kind: components["schemas"]["StepKind"];
            /**
             * Delay S
             * @default 0
             */
            delay_s: number;
            /**
             * Scale
             * @default 1
             */
            scale: number;
            /**
             * Bias
             * @default 0
             */
            bias: number;
            /**
             * Stretches
             * @default []
             */
            stretches: [
                number,
                number
            ][];
            /** Std */
            std?: number | null;
            /**
             * Basis
             * @default
             */
            basis: string;
        };
        /**
         * CorrectionRequest
         * @description What a mode is to be called, whether it is symmetric, and why the rule was wrong.
         */
        CorrectionRequest: {
            /** Number */
            number: number;
            /** Name */
            name: string;
            /** Symmetric */
            symmetric: boolean;
            /** Reason */
            reason: string;
        };
        /**
         * Correlation
         * @description Two sources of modes compared at their common points.
         */
        Correlation: {
            /** Modal Table Id */
            modal_table_id: number;
            /** Other Id */
            other_id: number;
            /** Fuel */
            fuel: number;
            /** Other Fuel */
            other_fuel: number;
            /** N Points */
            n_points: number;
            /** Pairs */
            pairs: components["schemas"]["PairedMode"][];
            /** Points */
            points: components["schemas"]["PointAgreement"][];
            /** Notes */
            notes: string[];
        };
        /**
         * Crew
         * @description The server that hands out work: who computes, and which runs they are at.
         *
         *     ``without_workers_s`` is how long no worker has been connected. [s]
         */
        Crew: {
            /** Server */
            server: string;
            /** Place */
            place: string;
            /** Workers */
            workers: number;
            /** Running */
            running: number[];
            /**
             * Without Workers S
             * @default 0
             */
            without_workers_s: number;
        };
        /**
         * CutRequest
         * @description A window of a flight that becomes a maneuver. [s]
         */
        CutRequest: {
            /** Label */
            label: string;
            /** Start S */
            start_s: number;
            /** Stop S */
            stop_s: number;
            /** Fta */
            fta?: number | null;
            /** Axis */
            axis?: ("longitudinal" | "lateral") | null;
            /**
             * Note
             * @default
             */
            note: string;
        };
        /**
         * Decision
         * @description Where a decision stands after its events; ``version`` counts them.
         *
         *     ``authors`` have made a revision of the proposal; ``votes`` are those that stand
         *     on the newest one.
         */
        Decision: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Axis */
            axis: string;
            proposal: components["schemas"]["StructureProposal"];
            state: components["schemas"]["DecisionState"];
            /** Revision */
            revision: number;
            /** Authors */
            authors: string[];
            /** Votes */
            votes?: {
                [key: string]: components["schemas"]["Vote"];
            };
            /** Superseded By */
            superseded_by?: number | null;
            /** Version */
            version: number;
            /** Created At */
            created_at?: string | null;
            /** Changed At */
            changed_at?: string | null;
            /** Adopted At */
            adopted_at?: string | null;
            /** Id */
            id?: number | null;
        };
        /**
         * DecisionDetail
         * @description A decision with its events, rules and what it proposes.
         *
         *     ``newest_version`` is that of the proposed structure by now.
         */
        DecisionDetail: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Axis */
            axis: string;
            proposal: components["schemas"]["StructureProposal"];
            state: components["schemas"]["DecisionState"];
            /** Revision */
            revision: number;
            /** Authors */
            authors: string[];
            /** Votes */
            votes?: {
                [key: string]: components["schemas"]["Vote"];
            };
            /** Superseded By */
            superseded_by?: number | null;
            /** Version */
            version: number;
            /** Created At */
            created_at?: string | null;
            /** Changed At */
            changed_at?: string | null;
            /** Adopted At */
            adopted_at?: string | null;
            /** Id */
            id?: number | null;
            rules: components["schemas"]["ReviewRules"];
            /** Events */
            events: components["schemas"]["DecisionEvent"][];
            structure: components["schemas"]["StructureVersion"];
            /** Newest Version */
            newest_version: number;
            changes: components["schemas"]["StructureVersion"] | null;
            /** Figures */
            figures: components["schemas"]["FrozenFigure"][];
        };
        /**
         * DecisionEvent
         * @description One entry of the record of a decision; written once and never changed.
         *
         *     ``author`` is the name that was set, which nobody verified. ``data`` names all
         *     that the event rests on by hash, ``data_hash`` is the hash of that. ``sealed`` is the
         *     event as JSON, ``previous_hash`` included, and ``hash`` the SHA-256 of that text, so
         *     that no entry can be changed or taken out unnoticed.
         */
        DecisionEvent: {
            /** Decision Id */
            decision_id: number;
            /** Number */
            number: number;
            kind: components["schemas"]["EventKind"];
            /** Author */
            author: string;
            /**
             * Author Verified
             * @default false
             */
            author_verified: boolean;
            /** Text */
            text: string;
            /** Revision */
            revision: number;
            /** Derivative */
            derivative?: string | null;
            vote?: components["schemas"]["Vote"] | null;
            proposal?: components["schemas"]["StructureProposal"] | null;
            rules?: components["schemas"]["ReviewRules"] | null;
            /** By Decision Id */
            by_decision_id?: number | null;
            /** Data */
            data: {
                [key: string]: string;
            };
            /** Data Hash */
            data_hash: string;
            /** Software */
            software: {
                [key: string]: string;
            };
            /** Previous Hash */
            previous_hash: string;
            /**
             * Sealed
             * @default
             */
            sealed: string;
            /**
             * Hash
             * @default
             */
            hash: string;
            /** Created At */
            created_at?: string | null;
            /** Id */
            id?: number | null;
        };
        /**
         * DecisionItem
         * @description A decision with the name of the structure that it proposes.
         */
        DecisionItem: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Axis */
            axis: string;
            proposal: components["schemas"]["StructureProposal"];
            state: components["schemas"]["DecisionState"];
            /** Revision */
            revision: number;
            /** Authors */
            authors: string[];
            /** Votes */
            votes?: {
                [key: string]: components["schemas"]["Vote"];
            };
            /** Superseded By */
            superseded_by?: number | null;
            /** Version */
            version: number;
            /** Created At */
            created_at?: string | null;
            /** Changed At */
            changed_at?: string | null;
            /** Adopted At */
            adopted_at?: string | null;
            /** Id */
            id?: number | null;
            /** Structure Name */
            structure_name: string;
        };
        /**
         * DecisionList
         * @description Decisions, newest first.
         */
        DecisionList: {
            /** Items */
            items: components["schemas"]["DecisionItem"][];
        };
        /**
         * DecisionState
         * @description Where a decision stands; the first two can still be voted on.
         * @enum {string}
         */
        DecisionState: "open" | "changes-requested" | "approved" | "rejected" | "withdrawn" | "superseded";
        /**
         * DerivativeTrend
         * @description One derivative over the conditions that were flown; ``unit`` is that of its values.
         */
        DerivativeTrend: {
            /** Name */
            name: string;
            /** Label */
            label: string;
            /** Unit */
            unit: string;
            against: components["schemas"]["Against"];
            /** Points */
            points: components["schemas"]["TrendPoint"][];
            /** Lines */
            lines: components["schemas"]["TrendLine"][];
        };
        /**
         * DerivativeValue
         * @description One predicted derivative.
         */
        DerivativeValue: {
            /** Name */
            name: string;
            /** Value */
            value: number;
            /** Std Error */
            std_error: number | null;
        };
        /**
         * DesignChecks
         * @description ``correlation`` is the largest between two inputs over one period.
         */
        DesignChecks: {
            /** Correlation */
            correlation: number;
            /** Inputs */
            inputs: components["schemas"]["InputCheck"][];
        };
        /**
         * DesignList
         * @description Designs, oldest first.
         */
        DesignList: {
            /** Items */
            items: components["schemas"]["ExcitationDesign"][];
            /** Next */
            next?: string | null;
        };
        /**
         * DesignRequest
         * @description A row of Table 1 by ``fta``, or ``inputs`` by their harmonics, or ``bands``.
         *
         *     ``peaks`` are the largest commands of an input with relative peak 1 in radians, at most 60 deg.
         *     With ``aircraft_id`` the harmonics of a row reach its target modes on that aircraft.
         */
        DesignRequest: {
            /** Name */
            name: string;
            /** Duration S */
            duration_s: number;
            /** Rate Hz */
            rate_hz: number;
            /** Peaks */
            peaks: [
                number,
                number,
                number
            ];
            /** Fta */
            fta?: number | null;
            /** Aircraft Id */
            aircraft_id?: number | null;
            /**
             * First Harmonic
             * @default 1
             */
            first_harmonic: number;
            /**
             * Inputs
             * @default []
             */
            inputs: components["schemas"]["InputRequest"][];
            /**
             * Bands
             * @default []
             */
            bands: components["schemas"]["BandRequest"][];
            /**
             * Effort
             * @default thorough
             * @enum {string}
             */
            effort: "quick" | "thorough" | "patient";
            /**
             * Seed
             * @default 0
             */
            seed: number;
            /**
             * Note
             * @default
             */
            note: string;
        };
        /**
         * Doubt
         * @description A question to the analyst: is this unit right?
         *
         *     ``confirmed = ["..."]`` in the mapping of the channel says yes; ``instead`` are
         *     units in which the samples would have a usual size.
         */
        Doubt: {
            /** Code */
            code: string;
            /** Channel */
            channel: string;
            /** Unit */
            unit: string;
            /** Largest */
            largest: number;
            /** Instead */
            instead: string[];
        };
        /**
         * DragPolar
         * @description Parabolic polar; gives trim angle of attack, and thrust that nobody recorded or tabled.
         */
        DragPolar: {
            /** Cd Min */
            cd_min: number;
            /** Oswald */
            oswald: number;
            /** Aspect Ratio */
            aspect_ratio: number;
            /** Lift Slope */
            lift_slope: number;
        };
        /**
         * EquivalentLine
         * @description A mode without air, from straight lines over dynamic pressure (Eq. 25).
         *
         *     ``table_hz`` is what the modal table says; the derivatives are C_Qi_eta_i and C_Qi_etadot_i.
         */
        EquivalentLine: {
            /** Mode */
            mode: number;
            /** Name */
            name: string;
            /** Table Hz */
            table_hz: number;
            /** Frequency Hz */
            frequency_hz: number;
            /** Frequency Std Hz */
            frequency_std_hz: number;
            /** Damping */
            damping: number;
            /** Damping Std */
            damping_std: number;
            /** Stiffness Derivative */
            stiffness_derivative: number;
            /** Stiffness Derivative Std */
            stiffness_derivative_std: number;
            /** Damping Derivative */
            damping_derivative: number;
            /** Damping Derivative Std */
            damping_derivative_std: number;
        };
        /**
         * EquivalentPoint
         * @description A mode as if it stood alone in the air of one run (Eq. 25), at the loading asked for.
         *
         *     Frequency and damping are None where the air has taken all stiffness.
         */
        EquivalentPoint: {
            /** Run Id */
            run_id: number;
            /** Label */
            label: string;
            /** Airspeed M S */
            airspeed_m_s: number;
            /** Dynamic Pressure Pa */
            dynamic_pressure_pa: number;
            /** Mode */
            mode: number;
            /** Name */
            name: string;
            /** Frequency Hz */
            frequency_hz: number | null;
            /** Frequency Std Hz */
            frequency_std_hz: number | null;
            /** Damping */
            damping: number | null;
            /** Damping Std */
            damping_std: number | null;
        };
        /**
         * EstimationRun
         * @description A request and, once done, its result.
         *
         *     Of those that wait, the one with the highest ``priority`` starts first, and none
         *     before ``after_run_id`` has succeeded. ``data_hash`` names what was recorded and
         *     assumed, ``input_hash`` that and all that was asked for: equal inputs are one run.
         *     ``rests_on`` are the hashes of the records it was computed from (None: not recorded, by an
         *     earlier release). ``result_hash`` was kept with the result; ``altered`` tells that the
         *     result, or what was asked for, is not any more what it was then.
         *     ``proposal`` is there where the model structure is the one that was proposed.
         */
        EstimationRun: {
            /** Maneuver Id */
            maneuver_id: number;
            method: components["schemas"]["Method"];
            structure: components["schemas"]["Structure"];
            settings: components["schemas"]["RunSettings"];
            /** Modal Table Id */
            modal_table_id?: number | null;
            /** Damping Table Id */
            damping_table_id?: number | null;
            /** Prediction Id */
            prediction_id?: number | null;
            /** Structure Id */
            structure_id?: number | null;
            /** Structure Version */
            structure_version?: number | null;
            /** @default queued */
            state: components["schemas"]["RunState"];
            /**
             * Attempt
             * @default 0
             */
            attempt: number;
            progress?: components["schemas"]["Progress"] | null;
            /** Error */
            error?: {
                [key: string]: string;
            } | null;
            result?: components["schemas"]["RunResult"] | null;
            /** Versions */
            versions?: {
                [key: string]: string;
            } | null;
            /**
             * Author
             * @default
             */
            author: string;
            /** Created At */
            created_at?: string | null;
            /** Started At */
            started_at?: string | null;
            /** Finished At */
            finished_at?: string | null;
            /** Deleted At */
            deleted_at?: string | null;
            /**
             * Priority
             * @default 0
             */
            priority: number;
            /** After Run Id */
            after_run_id?: number | null;
            limits?: components["schemas"]["Limits"] | null;
            /** Data Hash */
            data_hash?: string | null;
            /** Input Hash */
            input_hash?: string | null;
            /** Worker */
            worker?: string | null;
            /** Rests On */
            rests_on?: {
                [key: string]: string;
            } | null;
            /** Result Hash */
            result_hash?: string | null;
            /**
             * Altered
             * @default false
             */
            altered: boolean;
            proposal?: components["schemas"]["ProposalBasis"] | null;
            /** Id */
            id?: number | null;
        };
        /**
         * EventKind
         * @description What happened to a decision.
         * @enum {string}
         */
        EventKind: "proposed" | "revised" | "commented" | "voted" | "withdrawn" | "adopted" | "declined" | "superseded" | "narrowed";
        /**
         * Excitation
         * @description Which harmonics of 1/period each input owns (the sets K_j of Eq. 4).
         */
        Excitation: {
            /** Period S */
            period_s: number;
            /** Harmonics */
            harmonics: {
                [key: string]: number[];
            };
            /**
             * Start S
             * @default 0
             */
            start_s: number;
            /**
             * N Periods
             * @default 1
             */
            n_periods: number;
        };
        /**
         * ExcitationDesign
         * @description A design that is kept; ``wish`` and ``phases`` [rad] together reproduce it.
         *
         *     ``fta`` is the lowest number of the design in Table 1, where it is one.
         */
        ExcitationDesign: {
            /** Name */
            name: string;
            wish: components["schemas"]["Wish"];
            /** Phases */
            phases: {
                [key: string]: number[];
            };
            /** Peak Factors */
            peak_factors: {
                [key: string]: number;
            };
            /** Fta */
            fta?: number | null;
            /**
             * Note
             * @default
             */
            note: string;
            /** Created At */
            created_at?: string | null;
            /** Id */
            id?: number | null;
        };
        /**
         * ExpectedError
         * @description A derivative of a model and its predicted standard error under a design.
         */
        ExpectedError: {
            /** Name */
            name: string;
            /** Value */
            value: number;
            /** Std Error */
            std_error: number;
        };
        /**
         * ExpectedErrors
         * @description What a design would tell, and what the prediction rests on.
         *
         *     ``surfaces`` says how the surfaces were taken to follow their commands, and
         *     ``lines_outside`` how many lines lie outside the run's, where all is held constant.
         */
        ExpectedErrors: {
            /** Items */
            items: components["schemas"]["ExpectedError"][];
            /** Surfaces */
            surfaces: string;
            /** Lines Outside */
            lines_outside: number;
            /** Next */
            next?: string | null;
        };
        /**
         * ExpectedMode
         * @description How well a design shows a mode: the best output around its frequency.
         *
         *     ``lines`` are those within the mode's half-power band; ``signal_to_noise`` is the amplitude
         *     ratio of ``output`` there or at the nearest lines. Both are None where no line excites the
         *     mode. [Hz], [1], [1]
         */
        ExpectedMode: {
            /** Name */
            name: string;
            /** Frequency Hz */
            frequency_hz: number;
            /** Damping */
            damping: number;
            /** Lines */
            lines: number;
            /** Output */
            output: string | null;
            /** Signal To Noise */
            signal_to_noise: number | null;
        };
        /**
         * ExpectedSummary
         * @description Modes, correlation of the true deflections, parameters told by each input's lines.
         */
        ExpectedSummary: {
            /** Modes */
            modes: components["schemas"]["ExpectedMode"][];
            /** Surfaces */
            surfaces: string[];
            /** Correlation */
            correlation: number[][];
            /** Worth */
            worth: {
                [key: string]: number;
            };
        };
        /**
         * ExportedLines
         * @description One set of lines that was fitted; rows by frequency, columns by output.
         */
        ExportedLines: {
            /** Name */
            name: string;
            /** Outputs */
            outputs: string[];
            /** Omega */
            omega: number[];
            /** Measured Real */
            measured_real: number[][];
            /** Measured Imag */
            measured_imag: number[][];
            /** Fitted Real */
            fitted_real: number[][];
            /** Fitted Imag */
            fitted_imag: number[][];
        };
        /**
         * Facets
         * @description Lines that all filters together leave, and the choices of each filter by its name.
         */
        Facets: {
            /** Total */
            total: number;
            /** Choices */
            choices: {
                [key: string]: components["schemas"]["Choice"][];
            };
        };
        /**
         * FieldError
         * @description What is wrong with one field of a request.
         */
        FieldError: {
            /** Field */
            field: string;
            /** Message */
            message: string;
        };
        /**
         * Figure
         * @description What plotly draws; colours of the page, fonts and height are left to the page.
         */
        Figure: {
            /** Data */
            data: {
                [key: string]: unknown;
            }[];
            /** Layout */
            layout: {
                [key: string]: unknown;
            };
        };
        /**
         * Figures
         * @description The numbers that a campaign is sorted by.
         */
        Figures: {
            /** Signal To Noise Db */
            signal_to_noise_db?: number | null;
            /** Largest Skew S */
            largest_skew_s?: number | null;
            /** Largest Skew Channel */
            largest_skew_channel?: string | null;
            /** Least Coherence */
            least_coherence?: number | null;
            /**
             * N Stretches
             * @default 0
             */
            n_stretches: number;
            /**
             * Saturated
             * @default 0
             */
            saturated: number;
            /** Max Input Correlation */
            max_input_correlation?: number | null;
            /** Fuel Change */
            fuel_change?: number | null;
            /** Airspeed Drift */
            airspeed_drift?: number | null;
        };
        /**
         * Finding
         * @description One thing that an analyst should know; ``good`` is only information.
         */
        Finding: {
            severity: components["schemas"]["flexsid__records__quality__Verdict"];
            /** About */
            about: string;
            /** Channel */
            channel: string | null;
            /** Text */
            text: string;
        };
        /**
         * FirstOrder
         * @description Lag with unit static gain: wc / (s + wc).
         */
        FirstOrder: {
            /** Corner */
            corner: number;
        };
        /**
         * Fit
         * @description How the maximisation ended and how well the model fits.
         */
        Fit: {
            /** Outcome */
            outcome: string;
            /** Message */
            message: string;
            /** Iterations */
            iterations: components["schemas"]["Iteration"][];
            /** Cost */
            cost: number | null;
            /** R Squared */
            r_squared: {
                [key: string]: number;
            };
            /** N Lines */
            n_lines: number;
            /** N Parameters */
            n_parameters: number;
            /** Seconds */
            seconds: number;
            /** Start */
            start: string;
            /**
             * Warnings
             * @default []
             */
            warnings: string[];
            /**
             * Quality
             * @default []
             */
            quality: components["schemas"]["OutputQuality"][];
        };
        /**
         * FitBlock
         * @description One set of lines that was fitted: OE one, FRE one per input, EE one per coefficient.
         *
         *     ``arrays`` names hashes: ``omega`` (M,), ``measured`` and ``fitted`` (M, len(outputs)).
         */
        FitBlock: {
            /** Name */
            name: string;
            /** Outputs */
            outputs: string[];
            /** Arrays */
            arrays: {
                [key: string]: string;
            };
        };
        /**
         * FixedTo
         * @description A source by kind and id; a prediction is read at the fuel of the maneuver.
         */
        FixedTo: {
            source: components["schemas"]["HeldBy"];
            /** Id */
            id: number;
        };
        /**
         * FixedToRequest
         * @description A source that a derivative is held at.
         */
        FixedToRequest: {
            source: components["schemas"]["HeldBy"];
            /** Id */
            id: number;
        };
        /**
         * Flight
         * @description One flight; its maneuvers point back to it.
         */
        Flight: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Number */
            number: number;
            /** Flown On */
            flown_on?: string | null;
            /**
             * Description
             * @default
             */
            description: string;
            /** Id */
            id?: number | null;
        };
        /**
         * FlightChannel
         * @description One channel of a whole recording, from which maneuvers are cut.
         *
         *     Native rate, unit and precision; the field and file that it came from.
         */
        FlightChannel: {
            /** Flight Id */
            flight_id: number;
            /** Name */
            name: string;
            /** Unit */
            unit: string;
            role: components["schemas"]["Role"];
            /** Rate Hz */
            rate_hz: number;
            /** Start S */
            start_s: number;
            /** N Samples */
            n_samples: number;
            /** Array */
            array: string;
            /** Sensor */
            sensor?: string | null;
            /** Source File */
            source_file?: string | null;
            /** Source Hash */
            source_hash?: string | null;
            /** Source Field */
            source_field?: string | null;
            /** Id */
            id?: number | null;
        };
        /**
         * FlightChannelList
         * @description Channels of a whole flight.
         */
        FlightChannelList: {
            /** Items */
            items: components["schemas"]["FlightChannel"][];
        };
        /**
         * FlightConditionQuality
         * @description The flight condition with its spread, and whether one linear model holds over it.
         *
         *     ``separation_factor`` is the lowest structural over the highest rigid-body frequency of
         *     the predicted model: from five on, rigid and elastic motion may be taken apart.
         */
        FlightConditionQuality: {
            /** Averages */
            averages: components["schemas"]["Average"][];
            /** Airspeed Ratio */
            airspeed_ratio: number | null;
            /** Fuel Fraction */
            fuel_fraction: number;
            /** Fuel Change */
            fuel_change: number | null;
            /** Airspeed Drift */
            airspeed_drift: number | null;
            /** Separation Factor */
            separation_factor: number | null;
            /** Time Invariant */
            time_invariant: boolean | null;
        };
        /**
         * FlightList
         * @description Flights.
         */
        FlightList: {
            /** Items */
            items: components["schemas"]["Flight"][];
            /** Next */
            next?: string | null;
        };
        /**
         * Flutter
         * @description The answer to "next point at V: margin, and how sure"; ``safe`` if nothing is against it.
         *
         *     ``airspeed_std_m_s`` is statistical, ``spread_m_s`` the standard deviation between model
         *     structures, ``modal_std_m_s`` that from the frequencies of the modal table; ``low_m_s`` to
         *     ``high_m_s`` holds the flutter speed with 95 % probability. ``margin`` is that of the fastest
         *     point flown, ``known_m_s`` what the aircraft's table predicted before flight. ``refusal`` says
         *     why no flutter speed is taken from a model that flight contradicts, or whose unstable root the
         *     data do not determine; empty otherwise. Instabilities were searched from ``searched_from_m_s``
         *     to ``searched_to_m_s``.
         */
        Flutter: {
            /** Sentence */
            sentence: string;
            /** Refusal */
            refusal: string;
            /** Searched From M S */
            searched_from_m_s: number;
            /** Searched To M S */
            searched_to_m_s: number;
            /** Next Point */
            next_point: string;
            /** Safe */
            safe: boolean;
            /** Fuel Fraction */
            fuel_fraction: number;
            /** Density Kg M3 */
            density_kg_m3: number;
            /** Tested M S */
            tested_m_s: number;
            /** Margin */
            margin: number | null;
            /** Next M S */
            next_m_s: number;
            /** Airspeed M S */
            airspeed_m_s: number | null;
            /** Airspeed Std M S */
            airspeed_std_m_s: number | null;
            /** Spread M S */
            spread_m_s: number;
            /** Modal Std M S */
            modal_std_m_s: number;
            /** Low M S */
            low_m_s: number | null;
            /** High M S */
            high_m_s: number | null;
            /** Frequency Rad S */
            frequency_rad_s: number | null;
            /** Mechanism */
            mechanism: string | null;
            /** Participation */
            participation: components["schemas"]["Participation"][];
            /** Known M S */
            known_m_s: number | null;
            /** Structures */
            structures: components["schemas"]["StructureForecast"][];
            /** Runs */
            runs: components["schemas"]["RunForecast"][];
            /** Progress */
            progress: components["schemas"]["ProgressForecast"][];
            /** Trackers */
            trackers: components["schemas"]["TrackerForecast"][];
            /** Equivalents */
            equivalents: components["schemas"]["EquivalentLine"][];
            /** Equivalent Points */
            equivalent_points: components["schemas"]["EquivalentPoint"][];
        };
        /**
         * FlutterPoint
         * @description Where a root of a flutter analysis loses its damping.
         *
         *     ``analysis`` names what it is of: subcase, symmetry, Mach number, density, method. Where
         *     ``is_bound``, the root was not seen stable at a lower speed: it goes unstable at or below
         *     ``airspeed_m_s``. ``density_ratio`` and ``mach`` are None where the file gives none.
         */
        FlutterPoint: {
            /** Root */
            root: number;
            /** Airspeed M S */
            airspeed_m_s: number;
            /** Omega Rad S */
            omega_rad_s: number;
            /** @default flutter */
            kind: components["schemas"]["Instability"];
            /**
             * Is Bound
             * @default false
             */
            is_bound: boolean;
            /**
             * Analysis
             * @default
             */
            analysis: string;
            /** Mach */
            mach?: number | null;
            /** Density Ratio */
            density_ratio?: number | null;
        };
        /**
         * FlutterSummary
         * @description Roots of a flutter analysis (Nastran SOL 145) against airspeed.
         *
         *     ``arrays`` names ``analysis`` (N,), ``root`` (N,), ``airspeed`` (N,) [m/s], ``damping``
         *     (N,) structural damping g [1], ``omega`` and ``growth`` (N,), imaginary and real part of the
         *     root [rad/s, 1/s], and, where printed, ``density`` and ``mach`` (N,). A root is one of its
         *     analysis only. ``notes`` name the analyses, and what no speed is read from.
         */
        FlutterSummary: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Name */
            name: string;
            /** Points */
            points: components["schemas"]["FlutterPoint"][];
            /** Arrays */
            arrays: {
                [key: string]: string;
            };
            /**
             * Notes
             * @default []
             */
            notes: string[];
            /**
             * Origin
             * @default
             */
            origin: string;
            /** Id */
            id?: number | null;
        };
        /**
         * FlutterSummaryList
         * @description Flutter summaries.
         */
        FlutterSummaryList: {
            /** Items */
            items: components["schemas"]["FlutterSummary"][];
            /** Next */
            next?: string | null;
        };
        /**
         * FlutterSummaryRequest
         * @description What a flutter summary is called and in which unit its velocities are.
         */
        FlutterSummaryRequest: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Name */
            name: string;
            /**
             * Speed Unit
             * @enum {string}
             */
            speed_unit: "m/s" | "ft/s" | "in/s" | "kt" | "km/h";
        };
        /**
         * FlutterTable
         * @description Predicted open-loop flutter speed against fuel; campaigns are planned in V/V_f.
         */
        FlutterTable: {
            /** Fuel */
            fuel: number[];
            /** Speed M S */
            speed_m_s: number[];
        };
        /**
         * FoundField
         * @description One column of a file: its rate, if the file has a time, and its first values.
         */
        FoundField: {
            /** File */
            file: string;
            /** Field */
            field: string;
            /** Unit */
            unit: string;
            /** N Samples */
            n_samples: number;
            /** Rate Hz */
            rate_hz: number | null;
            /** First */
            first: (number | null)[];
            /** Smallest */
            smallest: number | null;
            /** Largest */
            largest: number | null;
        };
        /**
         * FoundManeuver
         * @description A stretch of a flight that looks like a maneuver, with trim before and after.
         *
         *     ``basis`` says what it was found by; ``maneuver_id`` names one that was cut there.
         */
        FoundManeuver: {
            /** Label */
            label: string;
            /** Start S */
            start_s: number;
            /** Stop S */
            stop_s: number;
            excitation: components["schemas"]["Excitation"] | null;
            /** N Periods */
            n_periods: number;
            /** Fta */
            fta: number | null;
            /** Basis */
            basis: string;
            /** Maneuver Id */
            maneuver_id?: number | null;
        };
        /**
         * FoundManeuverList
         * @description Stretches of a flight that look like maneuvers.
         */
        FoundManeuverList: {
            /** Items */
            items: components["schemas"]["FoundManeuver"][];
        };
        /**
         * FoundMode
         * @description A mode found in measured responses; the scatter is that over the model orders.
         */
        FoundMode: {
            /** Frequency Hz */
            frequency_hz: number;
            /** Std Hz */
            std_hz: number;
            /** Damping */
            damping: number;
            /** Std Damping */
            std_damping: number;
            /** N Orders */
            n_orders: number;
            /** Collinearity */
            collinearity: number;
        };
        /**
         * FoundModes
         * @description Modes found in measured responses; ``fit_error`` is relative, rms over all of them.
         */
        FoundModes: {
            /** Responses Id */
            responses_id: number;
            /** Fit Error */
            fit_error: number;
            /** Scaled */
            scaled: boolean;
            /** Items */
            items: components["schemas"]["FoundMode"][];
        };
        /**
         * FoundModesRequest
         * @description Which modes found in responses are to be kept, and under which name.
         */
        FoundModesRequest: {
            /** Name */
            name: string;
            /** Low Hz */
            low_hz?: number | null;
            /** High Hz */
            high_hz?: number | null;
            /**
             * Order
             * @default 30
             */
            order: number;
            /** Keep */
            keep?: number[] | null;
            /** Like Id */
            like_id?: number | null;
        };
        /**
         * FoundStretch
         * @description Samples that are a spike, a dropout or saturated, and when they begin. [s]
         */
        FoundStretch: {
            /** Kind */
            kind: string;
            /** First */
            first: number;
            /** Stop */
            stop: number;
            /** Start S */
            start_s: number;
        };
        /**
         * FreezeRequest
         * @description A figure of ``GET /figures/{kind}?{query}``, to be kept as it is now.
         */
        FreezeRequest: {
            /** Kind */
            kind: string;
            /** Query */
            query: string;
            /** Title */
            title: string;
        };
        /**
         * FrozenFigure
         * @description A figure as it was when somebody pointed to it; ``array`` holds its JSON.
         */
        FrozenFigure: {
            /** Kind */
            kind: string;
            /** Query */
            query: string;
            /** Title */
            title: string;
            /** Array */
            array: string;
            /** Author */
            author: string;
            /** Created At */
            created_at?: string | null;
            /** Id */
            id?: number | null;
        };
        /**
         * Geometry
         * @description Reference dimensions of the wing.
         */
        Geometry: {
            /** Area M2 */
            area_m2: number;
            /** Chord M */
            chord_m: number;
            /** Span M */
            span_m: number;
        };
        /**
         * Glossary
         * @description All quantities.
         */
        Glossary: {
            /** Items */
            items: components["schemas"]["GlossaryEntry"][];
            /** Next */
            next?: string | null;
        };
        /**
         * GlossaryEntry
         * @description One quantity of the glossary, with the unit that is stored and the one that people read.
         */
        GlossaryEntry: {
            /** Symbol */
            symbol: string;
            /** Unit */
            unit: string;
            /** Display Unit */
            display_unit: string;
            /** Label */
            label: string;
            /** Meaning */
            meaning: string;
        };
        /**
         * GroundTest
         * @description Pre-flight and post-flight record of one flight, compared.
         */
        GroundTest: {
            /** Flight Id */
            flight_id: number;
            /** Flight Number */
            flight_number: number;
            /** Before Id */
            before_id: number;
            /** After Id */
            after_id: number;
            /** Fuel Before */
            fuel_before: number;
            /** Fuel After */
            fuel_after: number;
            /** Peaks */
            peaks: components["schemas"]["PeakChange"][];
            verdict: components["schemas"]["flexsid__records__ground_test__Verdict"];
            /** Message */
            message: string;
        };
        /**
         * GroundTestList
         * @description Ground tests of all flights that have one.
         */
        GroundTestList: {
            /** Items */
            items: components["schemas"]["GroundTest"][];
        };
        /**
         * Guess
         * @description A value that nobody has confirmed, at its key, and the consequence of taking it.
         */
        Guess: {
            kind: components["schemas"]["GuessKind"];
            /** Key */
            key: string;
            /** Value */
            value: string;
            /** Consequence */
            consequence: string;
        };
        /**
         * GuessKind
         * @description What a guess is about.
         * @enum {string}
         */
        GuessKind: "aircraft" | "flight" | "clock" | "unit" | "role" | "condition";
        /**
         * Health
         * @description How the workbench is, and its parts: database, dispatcher, workers, clock.
         *
         *     ``status`` is ok, or degraded where a part is.
         */
        Health: {
            status: components["schemas"]["PartState"];
            /** Version */
            version: string;
            /** Database */
            database: string;
            /** Migration */
            migration: string;
            /** Parts */
            parts: components["schemas"]["PartHealth"][];
        };
        /**
         * HeldBy
         * @description Kind of source whose value a derivative is held at.
         * @enum {string}
         */
        HeldBy: "prediction" | "run";
        /**
         * InputCheck
         * @description One input: command and true deflection at their largest. [unit], [unit/s], [unit/s2]
         */
        InputCheck: {
            /** Name */
            name: string;
            /** Peak Factor */
            peak_factor: number;
            /** Command Peak */
            command_peak: number;
            /** Start */
            start: number;
            /** Deflection Peak */
            deflection_peak: number;
            /** Rate Peak */
            rate_peak: number;
            /** Acceleration Peak */
            acceleration_peak: number;
            /** Within Limits */
            within_limits: boolean;
        };
        /**
         * InputComparison
         * @description Multisine first, then classic inputs; standard errors in the order of ``names``.
         */
        InputComparison: {
            /** Names */
            names: string[];
            /** Values */
            values: number[];
            /** Inputs */
            inputs: components["schemas"]["ComparedInput"][];
            /** Next */
            next?: string | null;
        };
        /**
         * InputPair
         * @description Correlation of two inputs while the excitation ran.
         */
        InputPair: {
            /** First */
            first: string;
            /** Second */
            second: string;
            /** Correlation */
            correlation: number;
        };
        /**
         * InputRequest
         * @description One input; ``power`` of its lines is flat when left out.
         */
        InputRequest: {
            /** Name */
            name: string;
            /** Harmonics */
            harmonics: number[];
            /**
             * Relative Peak
             * @default 1
             */
            relative_peak: number;
            /** Power */
            power?: number[] | null;
        };
        /**
         * InputWish
         * @description One input: its harmonics, its peak relative to the design's, and the power of each line.
         *
         *     ``power`` is relative and flat when left out.
         */
        InputWish: {
            /** Name */
            name: string;
            /** Harmonics */
            harmonics: number[];
            /**
             * Relative Peak
             * @default 1
             */
            relative_peak: number;
            /** Power */
            power?: number[] | null;
        };
        /**
         * Instability
         * @description How a root of a flutter analysis goes unstable.
         * @enum {string}
         */
        Instability: "flutter" | "divergence";
        /**
         * Instrument
         * @description A chain of elements followed by a pure delay. [s]
         */
        Instrument: {
            /**
             * Elements
             * @default []
             */
            elements: (components["schemas"]["SecondOrder"] | components["schemas"]["FirstOrder"] | components["schemas"]["Butterworth"])[];
            /**
             * Delay S
             * @default 0
             */
            delay_s: number;
        };
        /**
         * Iteration
         * @description One step of the maximisation; the first one of a stage is where it starts.
         *
         *     Stages after the first fit lines that were corrected anew for the ends of the record: costs
         *     of different stages are of different data and cannot be compared.
         */
        Iteration: {
            /** Iteration */
            iteration: number;
            /** Cost */
            cost: number;
            /** Step */
            step: number;
            /**
             * Stage
             * @default 0
             */
            stage: number;
        };
        /**
         * Job
         * @description How far a run is; a job has the id of its run.
         */
        Job: {
            /** Id */
            id: number;
            /** Run Id */
            run_id: number;
            /** Maneuver Id */
            maneuver_id: number;
            /** Maneuver Label */
            maneuver_label: string;
            method: components["schemas"]["Method"];
            state: components["schemas"]["RunState"];
            /** Attempt */
            attempt: number;
            /** Priority */
            priority: number;
            /** After Run Id */
            after_run_id: number | null;
            progress: components["schemas"]["Progress"] | null;
            error: components["schemas"]["JobError"] | null;
            /** Worker */
            worker: string | null;
            /** Author */
            author: string;
            /**
             * Created At
             * Format: date-time
             */
            created_at: string;
            /** Started At */
            started_at: string | null;
            /** Finished At */
            finished_at: string | null;
        };
        /**
         * JobError
         * @description Why a run failed.
         */
        JobError: {
            /** Code */
            code: string;
            /** Message */
            message: string;
        };
        /**
         * JobList
         * @description A page of jobs.
         */
        JobList: {
            /** Items */
            items: components["schemas"]["Job"][];
            /** Next */
            next: string | null;
        };
        /**
         * JobLog
         * @description The log of a job, oldest line first.
         */
        JobLog: {
            /** Items */
            items: components["schemas"]["RunEvent"][];
        };
        /**
         * LatestRun
         * @description The newest run of one method.
         */
        LatestRun: {
            /** Id */
            id: number;
            state: components["schemas"]["RunState"];
        };
        /**
         * Limits
         * @description What a run may take before it is stopped; None leaves it to the server.
         */
        Limits: {
            /** Time S */
            time_s?: number | null;
            /** Memory Mb */
            memory_mb?: number | null;
        };
        /**
         * LimitsRequest
         * @description What a run may take before it is stopped.
         */
        LimitsRequest: {
            /** Time S */
            time_s?: number | null;
            /** Memory Mb */
            memory_mb?: number | null;
        };
        /**
         * LinkedComparison
         * @description Runs and predictions that were compared; ``coefficient`` where only one was.
         */
        LinkedComparison: {
            /** Run Ids */
            run_ids: number[];
            /**
             * Prediction Ids
             * @default []
             */
            prediction_ids: number[];
            /** Coefficient */
            coefficient?: string | null;
        };
        /**
         * Maneuver
         * @description One research maneuver: its interval, excitation and condition.
         */
        Maneuver: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Flight Id */
            flight_id: number;
            /** Label */
            label: string;
            /** Start S */
            start_s: number;
            /** Duration S */
            duration_s: number;
            condition: components["schemas"]["Condition"];
            /** Fta */
            fta?: number | null;
            /**
             * Axis
             * @default longitudinal
             */
            axis: string;
            excitation?: components["schemas"]["Excitation"] | null;
            /** Airspeed Ratio */
            airspeed_ratio?: number | null;
            /** Max Input Correlation */
            max_input_correlation?: number | null;
            /** Source File */
            source_file?: string | null;
            /** Source Hash */
            source_hash?: string | null;
            /**
             * Note
             * @default
             */
            note: string;
            /** Created At */
            created_at?: string | null;
            /** Deleted At */
            deleted_at?: string | null;
            /** Id */
            id?: number | null;
        };
        /**
         * ManeuverBaseline
         * @description The baseline of a maneuver; none where nothing was approved for its condition.
         */
        ManeuverBaseline: {
            /** Maneuver Id */
            maneuver_id: number;
            baseline: components["schemas"]["Baseline"] | null;
        };
        /**
         * ManeuverBaselineList
         * @description Baselines of maneuvers, in the order asked for.
         */
        ManeuverBaselineList: {
            /** Items */
            items: components["schemas"]["ManeuverBaseline"][];
        };
        /**
         * ManeuverDetail
         * @description A maneuver with what an analyst asks next.
         */
        ManeuverDetail: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Flight Id */
            flight_id: number;
            /** Label */
            label: string;
            /** Start S */
            start_s: number;
            /** Duration S */
            duration_s: number;
            condition: components["schemas"]["Condition"];
            /** Fta */
            fta?: number | null;
            /**
             * Axis
             * @default longitudinal
             */
            axis: string;
            excitation?: components["schemas"]["Excitation"] | null;
            /** Airspeed Ratio */
            airspeed_ratio?: number | null;
            /** Max Input Correlation */
            max_input_correlation?: number | null;
            /** Source File */
            source_file?: string | null;
            /** Source Hash */
            source_hash?: string | null;
            /**
             * Note
             * @default
             */
            note: string;
            /** Created At */
            created_at?: string | null;
            /** Deleted At */
            deleted_at?: string | null;
            /** Id */
            id?: number | null;
            /** Flight Number */
            flight_number: number;
            /** Aircraft Name */
            aircraft_name: string;
            /** Channels */
            channels: components["schemas"]["Channel"][];
            /** Tags */
            tags: string[];
        };
        /**
         * ManeuverItem
         * @description One line of the list.
         */
        ManeuverItem: {
            /** Id */
            id: number;
            /** Label */
            label: string;
            /** Flight Id */
            flight_id: number;
            /** Flight Number */
            flight_number: number;
            /** Aircraft Id */
            aircraft_id: number;
            /** Aircraft Name */
            aircraft_name: string;
            /** Fta */
            fta: number | null;
            /** Axis */
            axis: string;
            /** Duration S */
            duration_s: number;
            /** Airspeed M S */
            airspeed_m_s: number;
            /** Dynamic Pressure Pa */
            dynamic_pressure_pa: number;
            /** Airspeed Ratio */
            airspeed_ratio: number | null;
            /** Fuel Fraction */
            fuel_fraction: number;
            /** Max Input Correlation */
            max_input_correlation: number | null;
            /** N Runs */
            n_runs: number;
            /** Runs */
            runs: {
                [key: string]: components["schemas"]["LatestRun"] | null;
            };
            /** Tags */
            tags: string[];
            /**
             * Created At
             * Format: date-time
             */
            created_at: string;
            /** Deleted At */
            deleted_at: string | null;
        };
        /**
         * ManeuverList
         * @description A page of the filtered list of maneuvers.
         */
        ManeuverList: {
            /** Items */
            items: components["schemas"]["ManeuverItem"][];
            /** Next */
            next?: string | null;
        };
        /**
         * ManeuverQuality
         * @description What was found about a maneuver; ``content_hash`` tells what it rests on.
         */
        ManeuverQuality: {
            /** Maneuver Id */
            maneuver_id: number;
            /** Content Hash */
            content_hash: string;
            verdict: components["schemas"]["flexsid__records__quality__Verdict"];
            /** Summary */
            summary: string;
            figures: components["schemas"]["Figures"];
            report: components["schemas"]["QualityReport"];
            /** Created At */
            created_at?: string | null;
            /** Id */
            id?: number | null;
        };
        /**
         * MappedChannel
         * @description A channel as a mapping makes it.
         */
        MappedChannel: {
            /** Name */
            name: string;
            /** Unit */
            unit: string;
            role: components["schemas"]["Role"];
            /** File */
            file: string;
            /** Field */
            field: string;
            /** Rate Hz */
            rate_hz: number;
            /** Start S */
            start_s: number;
            /** N Samples */
            n_samples: number;
            /** Smallest */
            smallest: number;
            /** Largest */
            largest: number;
        };
        /**
         * MappingList
         * @description Kept mappings.
         */
        MappingList: {
            /** Items */
            items: components["schemas"]["StoredMapping"][];
        };
        /**
         * MappingRequest
         * @description Keep a mapping under a name.
         */
        MappingRequest: {
            /** Name */
            name: string;
            /** Text */
            text: string;
            /**
             * Note
             * @default
             */
            note: string;
        };
        /**
         * MarginRow
         * @description Margins of one surface's loop at one airspeed; None where unstable or not crossed.
         *
         *     A gain margin scatters as a factor: ``gain_std`` is the standard deviation of its logarithm.
         */
        MarginRow: {
            /** Surface */
            surface: string;
            /** Airspeed M S */
            airspeed_m_s: number;
            /** Gain */
            gain: number | null;
            /** Gain Std */
            gain_std: number | null;
            /** Phase Rad */
            phase_rad: number | null;
            /** Phase Std Rad */
            phase_std_rad: number | null;
            /** Disk */
            disk: number | null;
            /** Disk Std */
            disk_std: number | null;
        };
        /**
         * MassTable
         * @description Mass properties against fuel fraction; centre of gravity in structural axes.
         */
        MassTable: {
            /** Fuel */
            fuel: number[];
            /** Mass Kg */
            mass_kg: number[];
            /** Pitch Inertia Kg M2 */
            pitch_inertia_kg_m2: number[];
            /** X Cg M */
            x_cg_m: number[];
            /** Z Cg M */
            z_cg_m: number[];
        };
        /**
         * MeasuredResponses
         * @description Frequency responses of a ground vibration test.
         *
         *     ``outputs`` and ``references`` name node and direction (``12+z``). ``arrays`` names
         *     ``frequency`` (M,) [Hz], ``values`` (M, n_outputs, n_references), and where the geometry
         *     is known ``nodes`` (n_outputs, 3) [m] and ``directions`` (n_outputs, 3), structural axes.
         *     ``quantity`` is what the response is: displacement, velocity or acceleration per force.
         */
        MeasuredResponses: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Name */
            name: string;
            /** Fuel */
            fuel: number;
            /** Quantity */
            quantity: string;
            /** Outputs */
            outputs: string[];
            /** References */
            references: string[];
            /** Arrays */
            arrays: {
                [key: string]: string;
            };
            /**
             * Notes
             * @default []
             */
            notes: string[];
            /**
             * Origin
             * @default
             */
            origin: string;
            /** Id */
            id?: number | null;
        };
        /**
         * MeasuredResponsesList
         * @description Sets of measured responses.
         */
        MeasuredResponsesList: {
            /** Items */
            items: components["schemas"]["MeasuredResponses"][];
            /** Next */
            next?: string | null;
        };
        /**
         * Method
         * @description The three maximum-likelihood methods of the paper.
         * @enum {string}
         */
        Method: "OE" | "FRE" | "EE";
        /**
         * ModalKind
         * @description Where a modal table comes from.
         * @enum {string}
         */
        ModalKind: "FEM" | "GVT";
        /**
         * ModalTable
         * @description In-vacuo modes against fuel fraction; the numbers themselves are stored arrays.
         *
         *     ``arrays`` names content hashes (F fuels, n modes, P points, G gauges, K nodes):
         *     ``omega`` (F, n) [rad/s], ``zeta`` (F, n), ``mass`` (F, n) [kg m2],
         *     ``shape`` (F, n, P, 6) translation [m] and rotation [rad] per unit eta in body
         *     axes, ``strain`` (F, n, G) per unit eta, ``nodes`` (K, 3) structural axes [m],
         *     ``node_shape`` (F, n, K, 6). Only ``omega`` or ``zeta`` must be there.
         *
         *     Of large structures the shapes at the nodes lie in the table ``modal_shapes``, one array
         *     per fuel weight and mode; ``node_ids`` (K,), ``lines`` (L, 2) between rows of ``nodes``,
         *     and ``shown`` (rows) and ``shown_lines`` what is drawn. ``order`` and ``sign`` (F, n) say
         *     how each row follows from the first one, ``assurance`` (F, n) how surely.
         *
         *     Tables of one name are versions of each other. ``reasons`` tell why each mode is called
         *     and judged as it is, ``notes`` what was said of the source when it was imported.
         */
        ModalTable: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Name */
            name: string;
            kind: components["schemas"]["ModalKind"];
            /** Fuel */
            fuel: number[];
            /** Numbers */
            numbers: number[];
            /** Names */
            names: string[];
            /** Symmetric */
            symmetric: boolean[];
            /**
             * Points
             * @default []
             */
            points: string[];
            /**
             * Gauges
             * @default []
             */
            gauges: string[];
            /** Arrays */
            arrays: {
                [key: string]: string;
            };
            /**
             * Origin
             * @default
             */
            origin: string;
            /**
             * Version
             * @default 1
             */
            version: number;
            /**
             * Reasons
             * @default []
             */
            reasons: string[];
            /**
             * Notes
             * @default []
             */
            notes: string[];
            /** Id */
            id?: number | null;
        };
        /**
         * ModalTableDetail
         * @description A modal table with its frequencies [rad/s] and damping ratios, one row per fuel.
         */
        ModalTableDetail: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Name */
            name: string;
            kind: components["schemas"]["ModalKind"];
            /** Fuel */
            fuel: number[];
            /** Numbers */
            numbers: number[];
            /** Names */
            names: string[];
            /** Symmetric */
            symmetric: boolean[];
            /**
             * Points
             * @default []
             */
            points: string[];
            /**
             * Gauges
             * @default []
             */
            gauges: string[];
            /** Arrays */
            arrays: {
                [key: string]: string;
            };
            /**
             * Origin
             * @default
             */
            origin: string;
            /**
             * Version
             * @default 1
             */
            version: number;
            /**
             * Reasons
             * @default []
             */
            reasons: string[];
            /**
             * Notes
             * @default []
             */
            notes: string[];
            /** Id */
            id?: number | null;
            /** Omega */
            omega: number[][] | null;
            /** Zeta */
            zeta: number[][] | null;
        };
        /**
         * ModalTableList
         * @description Modal tables.
         */
        ModalTableList: {
            /** Items */
            items: components["schemas"]["ModalTable"][];
            /** Next */
            next?: string | null;
        };
        /**
         * ModeAtFuel
         * @description One mode of a table at one fuel fraction; numbers that are not known are None.
         */
        ModeAtFuel: {
            /** Number */
            number: number;
            /** Name */
            name: string;
            /** Symmetric */
            symmetric: boolean;
            /** Reason */
            reason: string;
            /** Frequency Hz */
            frequency_hz: number;
            /** Damping */
            damping: number | null;
            /** Mass Kg M2 */
            mass_kg_m2: number | null;
            /** Followed */
            followed: number | null;
        };
        /**
         * ModeCorrection
         * @description What an analyst calls a mode, and whether it is symmetric, against the rule; and why.
         */
        ModeCorrection: {
            /** Modal Table Id */
            modal_table_id: number;
            /** Number */
            number: number;
            /** Name */
            name: string;
            /** Symmetric */
            symmetric: boolean;
            /** Reason */
            reason: string;
            /**
             * Author
             * @default
             */
            author: string;
            /** Created At */
            created_at?: string | null;
            /** Id */
            id?: number | null;
        };
        /**
         * ModeInBand
         * @description A symmetric mode in the excited band or just above it.
         *
         *     ``air_frequency_hz`` and ``half_power_hz`` (full width at half power) are predicted at the
         *     condition of the maneuver; without a prediction the width is that in vacuo.
         */
        ModeInBand: {
            /** Number */
            number: number;
            /** Name */
            name: string;
            /** Frequency Hz */
            frequency_hz: number;
            /** Air Frequency Hz */
            air_frequency_hz: number | null;
            /** Half Power Hz */
            half_power_hz: number;
            /** In Band */
            in_band: boolean;
            /** Proposed */
            proposed: boolean;
        };
        /**
         * ModeList
         * @description Modes of a table at one fuel fraction, in order of frequency.
         */
        ModeList: {
            /** Modal Table Id */
            modal_table_id: number;
            /** Fuel */
            fuel: number;
            /** Items */
            items: components["schemas"]["ModeAtFuel"][];
        };
        /**
         * ModelExport
         * @description The model of a run at the condition of its maneuver, in SI units and radians.
         *
         *     x' = A x + B u, y = C x + D u; a sensor reads ``scales`` times y, ``delays_s``
         *     later. ``units`` names the unit of every state, input and output. Instruments
         *     are not part of the model.
         */
        ModelExport: {
            /** Run Id */
            run_id: number;
            /** Maneuver Id */
            maneuver_id: number;
            method: components["schemas"]["Method"];
            /** Airspeed M S */
            airspeed_m_s: number;
            /** Dynamic Pressure Pa */
            dynamic_pressure_pa: number;
            /** Fuel Fraction */
            fuel_fraction: number;
            /** Modes */
            modes: number[];
            /** States */
            states: string[];
            /** Inputs */
            inputs: string[];
            /** Outputs */
            outputs: string[];
            /** Units */
            units: {
                [key: string]: string;
            };
            /** A */
            A: number[][];
            /** B */
            B: number[][];
            /** C */
            C: number[][];
            /** D */
            D: number[][];
            /** Delays S */
            delays_s: number[];
            /** Scales */
            scales: number[];
            /** Derivatives */
            derivatives: {
                [key: string]: number;
            };
            /** Versions */
            versions: {
                [key: string]: string;
            } | null;
        };
        /**
         * ModelOrder
         * @description Reduced models of every order at one condition, against the full one.
         */
        ModelOrder: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Modal Table Id */
            modal_table_id: number;
            /** Prediction Id */
            prediction_id: number;
            /** Airspeed M S */
            airspeed_m_s: number;
            /** Fuel */
            fuel: number;
            /** Needed */
            needed: number;
            /** Evidence */
            evidence: string[];
            /** Full */
            full: {
                [key: string]: number;
            };
            /** Steps */
            steps: components["schemas"]["OrderStep"][];
        };
        /**
         * ModelStructure
         * @description A named structure that runs can share, as its newest version has it.
         */
        ModelStructure: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Name */
            name: string;
            structure: components["schemas"]["Structure"];
            /**
             * Note
             * @default
             */
            note: string;
            /**
             * Author
             * @default
             */
            author: string;
            /**
             * Version
             * @default 1
             */
            version: number;
            /** Created At */
            created_at?: string | null;
            /** Changed At */
            changed_at?: string | null;
            /** Id */
            id?: number | null;
        };
        /**
         * ModelStructureList
         * @description Model structures.
         */
        ModelStructureList: {
            /** Items */
            items: components["schemas"]["ModelStructure"][];
            /** Next */
            next?: string | null;
        };
        /**
         * ModelStructureRequest
         * @description Keep a model structure under a name.
         */
        ModelStructureRequest: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Name */
            name: string;
            structure: components["schemas"]["StructureRequest"];
            /**
             * Note
             * @default
             */
            note: string;
        };
        /**
         * Notifications
         * @description What waits, and the newest changes (at most 100), newest first.
         */
        Notifications: {
            /** Waiting */
            waiting: components["schemas"]["Waiting"][];
            /** Changes */
            changes: components["schemas"]["Change"][];
        };
        /**
         * Observability
         * @description Which sensor sees which mode, and where a further one would help most.
         *
         *     ``seen`` says for each mode the best share any sensor has; ``std_error`` is relative to
         *     the best known mode's, None for a mode that cannot be told apart.
         */
        Observability: {
            /** Modal Table Id */
            modal_table_id: number;
            /** Fuel */
            fuel: number;
            /** Numbers */
            numbers: number[];
            /** Names */
            names: string[];
            /** Rows */
            rows: components["schemas"]["SensorRow"][];
            /** Std Error */
            std_error: (number | null)[];
            /** Candidates */
            candidates: components["schemas"]["Candidate"][];
        };
        /**
         * OrderStep
         * @description A model that keeps so many modes; None where a number does not exist.
         */
        OrderStep: {
            /** Modes */
            modes: number[];
            /** Names */
            names: string[];
            /** Worst */
            worst: string;
            /** Bias */
            bias: number;
            /** Pole Error */
            pole_error: number | null;
            /** Response Error */
            response_error: number | null;
            /** Poles */
            poles: [
                number,
                number
            ][];
            /** Truncated Poles */
            truncated_poles: [
                number,
                number
            ][];
            /** Residualized */
            residualized: {
                [key: string]: number;
            };
            /** Truncated */
            truncated: {
                [key: string]: number;
            };
            /** Sufficient */
            sufficient: boolean;
        };
        /**
         * Orthogonality
         * @description Shapes over a mass matrix: one on the diagonal; ``worst`` is the largest beside it.
         */
        Orthogonality: {
            /** Modal Table Id */
            modal_table_id: number;
            /** Fuel */
            fuel: number;
            /** Names */
            names: string[];
            /** Values */
            values: number[][];
            /** Worst */
            worst: number;
        };
        /**
         * OrthogonalityRequest
         * @description Which field of the files is the mass matrix, and whose shapes are taken.
         */
        OrthogonalityRequest: {
            /** Modal Table Id */
            modal_table_id: number;
            /** Field */
            field: string;
            /**
             * Fuel
             * @default 0.5
             */
            fuel: number;
        };
        /**
         * Others
         * @description What becomes of the modes that a run left out.
         * @enum {string}
         */
        Others: "predicted" | "residualized";
        /**
         * OutputQuality
         * @description Fit of one output of one block: R2, Theil's inequality, probability of white residuals.
         */
        OutputQuality: {
            /** Block */
            block: string;
            /** Output */
            output: string;
            /** R Squared */
            r_squared: number;
            /** Theil */
            theil: number;
            /** Whiteness */
            whiteness: number;
        };
        /**
         * Pair
         * @description How two sources agree over all derivatives that both estimated.
         *
         *     ``rms_sigma`` is the root mean square of their normalised differences, one where
         *     they scatter as their errors say; ``worst`` names the derivative that differs most.
         */
        Pair: {
            /** First */
            first: string;
            /** Second */
            second: string;
            /** N */
            n: number;
            /** Rms Sigma */
            rms_sigma: number;
            /** Chi Square */
            chi_square: number;
            /** Probability */
            probability: number;
            /** Worst */
            worst: string;
            /** Worst Sigma */
            worst_sigma: number;
        };
        /**
         * PairedMode
         * @description A mode of one source and the one of another that is most alike.
         */
        PairedMode: {
            /** Number */
            number: number;
            /** Name */
            name: string;
            /** Other Number */
            other_number: number;
            /** Other Name */
            other_name: string;
            /** Mac */
            mac: number;
            /** Frequency Hz */
            frequency_hz: number;
            /** Other Hz */
            other_hz: number;
            /** Frequency Change */
            frequency_change: number;
            /** Damping */
            damping: number | null;
            /** Other Damping */
            other_damping: number | null;
        };
        /**
         * ParameterEstimate
         * @description One estimated derivative or delay; ``no_error`` says why ``std_error`` is None.
         */
        ParameterEstimate: {
            /** Name */
            name: string;
            /** Value */
            value: number;
            /** Std Error */
            std_error: number | null;
            /** Start */
            start?: number | null;
            /** Cramer Rao */
            cramer_rao?: number | null;
            /** Insensitivity */
            insensitivity?: number | null;
            /** No Error */
            no_error?: string | null;
        };
        /**
         * PartHealth
         * @description One part of the workbench, how it is, and where it is not well what to do.
         */
        PartHealth: {
            /** Name */
            name: string;
            state: components["schemas"]["PartState"];
            /** Text */
            text: string;
        };
        /**
         * PartState
         * @description How a part of the workbench is.
         * @enum {string}
         */
        PartState: "ok" | "starting" | "degraded";
        /**
         * Participation
         * @description Share of one motion in the root that becomes unstable.
         */
        Participation: {
            /** Name */
            name: string;
            /** Share */
            share: number;
        };
        /**
         * PeakChange
         * @description One peak before and after a flight.
         *
         *     Changes are relative. ``explained`` is what the modal table says of the fuel burnt,
         *     ``unexplained`` what is left, with its standard error.
         */
        PeakChange: {
            /** Mode */
            mode: number;
            /** Name */
            name: string;
            /** Before Hz */
            before_hz: number;
            /** Before Std Hz */
            before_std_hz: number;
            /** After Hz */
            after_hz: number | null;
            /** After Std Hz */
            after_std_hz: number | null;
            /** Change */
            change: number | null;
            /** Explained */
            explained: number;
            /** Unexplained */
            unexplained: number | null;
            /** Unexplained Std */
            unexplained_std: number | null;
            /** Amplitude Change */
            amplitude_change: number | null;
            /** Amplitude Explained */
            amplitude_explained: number;
            /** Amplitude Std */
            amplitude_std: number | null;
            verdict: components["schemas"]["flexsid__records__ground_test__Verdict"];
        };
        /**
         * PointAgreement
         * @description COMAC of one point in one direction.
         */
        PointAgreement: {
            /** Point */
            point: string;
            /** Direction */
            direction: string;
            /** Comac */
            comac: number;
        };
        /**
         * Pole
         * @description An eigenvalue of the identified model with its standard errors.
         */
        Pole: {
            /** Real */
            real: number;
            /** Imag */
            imag: number;
            /**
             * Name
             * @default
             */
            name: string;
            /** Real Std */
            real_std?: number | null;
            /** Imag Std */
            imag_std?: number | null;
            /** Frequency */
            frequency?: number | null;
            /** Frequency Std */
            frequency_std?: number | null;
            /** Damping */
            damping?: number | null;
            /** Damping Std */
            damping_std?: number | null;
        };
        /**
         * PredictedLines
         * @description Lines that a candidate was not fitted to: negative log likelihood, and R2.
         */
        PredictedLines: {
            /** Name */
            name: string;
            /** Cost */
            cost: number | null;
            /** R Squared */
            r_squared: number | null;
        };
        /**
         * Prediction
         * @description Derivatives by name against fuel; ``values`` is the hash of a (F, len(names)) array.
         */
        Prediction: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Source */
            source: string;
            /** Kind */
            kind: string;
            /** Fuel */
            fuel: number[];
            /** Names */
            names: string[];
            /** Values */
            values: string;
            /** Std Errors */
            std_errors?: string | null;
            /**
             * Note
             * @default
             */
            note: string;
            /** Id */
            id?: number | null;
        };
        /**
         * PredictionDetail
         * @description A prediction with its derivatives at one fuel fraction.
         */
        PredictionDetail: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Source */
            source: string;
            /** Kind */
            kind: string;
            /** Fuel */
            fuel: number[];
            /** Names */
            names: string[];
            /** Values */
            values: string;
            /** Std Errors */
            std_errors?: string | null;
            /**
             * Note
             * @default
             */
            note: string;
            /** Id */
            id?: number | null;
            /** At Fuel */
            at_fuel: number;
            /** Derivatives */
            derivatives: components["schemas"]["DerivativeValue"][];
        };
        /**
         * PredictionList
         * @description Predictions.
         */
        PredictionList: {
            /** Items */
            items: components["schemas"]["Prediction"][];
            /** Next */
            next?: string | null;
        };
        /**
         * PreviewRequest
         * @description A mapping and the channels of it that are drawn; the first ones where none is named.
         */
        PreviewRequest: {
            /** Mapping */
            mapping: string;
            /**
             * Channels
             * @default []
             */
            channels: string[];
        };
        /**
         * Progress
         * @description Last thing that a running job said.
         */
        Progress: {
            /**
             * Iteration
             * @default 0
             */
            iteration: number;
            /** Cost */
            cost?: number | null;
            /**
             * Fraction
             * @default 0
             */
            fraction: number;
            /**
             * Message
             * @default
             */
            message: string;
        };
        /**
         * ProgressForecast
         * @description Flutter speed from all runs up to an airspeed, with its 95 % interval.
         */
        ProgressForecast: {
            /** Tested M S */
            tested_m_s: number;
            /** N Runs */
            n_runs: number;
            /** Airspeed M S */
            airspeed_m_s: number | null;
            /** Low M S */
            low_m_s: number | null;
            /** High M S */
            high_m_s: number | null;
        };
        /**
         * Proposal
         * @description A mapping to begin with; ``origin`` says where it comes from.
         */
        Proposal: {
            /** Text */
            text: string;
            /** Origin */
            origin: string;
            /** Fitting */
            fitting: string[];
        };
        /**
         * ProposalBasis
         * @description Why a run has its model structure, where it follows the proposal; kept with the run.
         *
         *     ``decision_id`` names the approval of a baseline, ``run_id`` the run of the same FTA that
         *     used a saved structure.
         */
        ProposalBasis: {
            source: components["schemas"]["ProposalSource"];
            /** Reasons */
            reasons: string[];
            /** Band Hz */
            band_hz: [
                number,
                number
            ];
            /** Decision Id */
            decision_id?: number | null;
            /** Structure Id */
            structure_id?: number | null;
            /** Structure Version */
            structure_version?: number | null;
            /** Run Id */
            run_id?: number | null;
        };
        /**
         * ProposalRequest
         * @description A model structure for a range of conditions, and what speaks for it.
         *
         *     ``limits`` are closed intervals; without any it is proposed for all conditions.
         */
        ProposalRequest: {
            /** Title */
            title: string;
            structure: components["schemas"]["ReferenceRequest"];
            /** Reasoning */
            reasoning: string;
            changes?: components["schemas"]["ReferenceRequest"] | null;
            /** Limits */
            limits?: {
                [key: string]: [
                    number,
                    number
                ];
            } | null;
            /**
             * Run Ids
             * @default []
             */
            run_ids: number[];
            /**
             * Comparisons
             * @default []
             */
            comparisons: components["schemas"]["ComparisonRequest"][];
            /**
             * Figure Ids
             * @default []
             */
            figure_ids: number[];
        };
        /**
         * ProposalSource
         * @description What a proposal rests on, the strongest first.
         * @enum {string}
         */
        ProposalSource: "approved-baseline" | "saved-structure" | "band";
        /**
         * QualityItem
         * @description One line of the list; verdict, summary and figures are None until it was looked at.
         */
        QualityItem: {
            /** Maneuver Id */
            maneuver_id: number;
            /** Label */
            label: string;
            /** Flight Id */
            flight_id: number;
            /** Flight Number */
            flight_number: number;
            /** Aircraft Id */
            aircraft_id: number;
            /** Aircraft Name */
            aircraft_name: string;
            /** Fta */
            fta: number | null;
            /** Airspeed Ratio */
            airspeed_ratio: number | null;
            /** Fuel Fraction */
            fuel_fraction: number;
            verdict: components["schemas"]["flexsid__records__quality__Verdict"] | null;
            /** Summary */
            summary: string | null;
            figures: components["schemas"]["Figures"] | null;
        };
        /**
         * QualityList
         * @description A page of the quality of a campaign; ``counts`` are maneuvers by verdict.
         */
        QualityList: {
            /** Items */
            items: components["schemas"]["QualityItem"][];
            /** Counts */
            counts: {
                [key: string]: number;
            };
            assessing: components["schemas"]["Assessing"];
            /** Next */
            next: string | null;
        };
        /**
         * QualityReport
         * @description All that was found; ``not_checked`` says what could not be looked at, and why.
         */
        QualityReport: {
            /** Channels */
            channels: components["schemas"]["ChannelQuality"][];
            condition: components["schemas"]["FlightConditionQuality"];
            /** Inputs */
            inputs: components["schemas"]["InputPair"][];
            /** Findings */
            findings: components["schemas"]["Finding"][];
            /** Skew Reference */
            skew_reference: string | null;
            /** Skew Band Hz */
            skew_band_hz: [
                number,
                number
            ] | null;
            /** Not Checked */
            not_checked: string[];
        };
        /**
         * Quantity
         * @description What a range of conditions can limit.
         * @enum {string}
         */
        Quantity: "dynamic_pressure_pa" | "fuel_fraction" | "airspeed_m_s" | "airspeed_ratio" | "alpha_rad";
        /**
         * Question
         * @description Something that the files do not say.
         */
        Question: {
            /** Field */
            field: string;
            /** Text */
            text: string;
            /** Choices */
            choices: string[];
        };
        /**
         * QueueStatus
         * @description How the queue goes: runs by state, ended lately, and when it will be empty at this rate.
         */
        QueueStatus: {
            /** States */
            states: {
                [key: string]: number;
            };
            /** Ended */
            ended: number;
            /** Window S */
            window_s: number;
            /** Remaining S */
            remaining_s: number | null;
            crew: components["schemas"]["Crew"] | null;
        };
        /**
         * QueuedBatch
         * @description A batch that was queued; ``repeated`` of its runs had been asked for before.
         */
        QueuedBatch: {
            /** Id */
            id: number;
            /** Total */
            total: number;
            /** Repeated */
            repeated: number;
        };
        /**
         * RedesignRequest
         * @description The same lines with other phases.
         */
        RedesignRequest: {
            /** Name */
            name: string;
            /**
             * Effort
             * @default thorough
             * @enum {string}
             */
            effort: "quick" | "thorough" | "patient";
        };
        /**
         * ReferenceRequest
         * @description One version of one model structure.
         */
        ReferenceRequest: {
            /** Id */
            id: number;
            /** Version */
            version: number;
        };
        /**
         * Rehearsal
         * @description Which design, at which amplitude, with whose model and controller; what came of it.
         */
        Rehearsal: {
            /** Design Id */
            design_id: number;
            /** Level */
            level: number;
            /** Model Run Id */
            model_run_id: number;
            /** Controller Id */
            controller_id: number | null;
            /** Maneuver Id */
            maneuver_id: number;
            /** Run Id */
            run_id: number;
            /** Created At */
            created_at?: string | null;
            /** Id */
            id?: number | null;
        };
        /**
         * RehearsalList
         * @description Rehearsals of one design.
         */
        RehearsalList: {
            /** Items */
            items: components["schemas"]["RehearsalResult"][];
            /** Next */
            next?: string | null;
        };
        /**
         * RehearsalRequest
         * @description Whose model flies, at which amplitude, and which controller holds it; none for open loop.
         */
        RehearsalRequest: {
            /** Run Id */
            run_id: number;
            /**
             * Level
             * @default 1
             */
            level: number;
            /** Controller Id */
            controller_id?: number | null;
        };
        /**
         * RehearsalResult
         * @description A rehearsal, how far its run is, and the derivatives once it has succeeded.
         */
        RehearsalResult: {
            rehearsal: components["schemas"]["Rehearsal"];
            /** Label */
            label: string;
            state: components["schemas"]["RunState"];
            /** Correlation */
            correlation: number | null;
            /** Derivatives */
            derivatives: components["schemas"]["RehearsedDerivative"][];
        };
        /**
         * RehearsedDerivative
         * @description A derivative of the model that flew, what was estimated, and what had been expected.
         */
        RehearsedDerivative: {
            /** Name */
            name: string;
            /** Flown */
            flown: number;
            /** Estimate */
            estimate: number;
            /** Std Error */
            std_error: number | null;
            /** Expected */
            expected: number;
        };
        /**
         * RescaleRequest
         * @description Factors on the amplitudes of inputs; those left out stay.
         */
        RescaleRequest: {
            /** Name */
            name: string;
            /** Gains */
            gains: {
                [key: string]: number;
            };
            /**
             * Note
             * @default
             */
            note: string;
        };
        /**
         * ResponsesRequest
         * @description What an analyst says of measured responses; see ``ResponseAnswers``.
         */
        ResponsesRequest: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Name */
            name: string;
            /**
             * Response Unit
             * @enum {string}
             */
            response_unit: "m/s2" | "g" | "in/s2" | "ft/s2" | "m/s" | "in/s" | "m" | "mm" | "in" | "ft";
            /**
             * Force Unit
             * @enum {string}
             */
            force_unit: "N" | "lbf";
            /**
             * Fuel
             * @default 0
             */
            fuel: number;
            /** Length Unit */
            length_unit?: ("m" | "mm" | "in" | "ft") | null;
            /**
             * Axes
             * @default aft right up
             */
            axes: string;
            /**
             * Origin
             * @default [
             *       0,
             *       0,
             *       0
             *     ]
             */
            origin: [
                number,
                number,
                number
            ];
        };
        /**
         * ReviewRules
         * @description How many must approve, and whether one's own proposal may be judged; one per change.
         */
        ReviewRules: {
            /** Aircraft Id */
            aircraft_id: number;
            /**
             * Quorum
             * @default 1
             */
            quorum: number;
            /**
             * Own Allowed
             * @default false
             */
            own_allowed: boolean;
            /**
             * Version
             * @default 0
             */
            version: number;
            /**
             * Reason
             * @default
             */
            reason: string;
            /**
             * Author
             * @default
             */
            author: string;
            /** Created At */
            created_at?: string | null;
            /** Id */
            id?: number | null;
        };
        /**
         * RevisionRequest
         * @description Another proposal in the place of ``revision``.
         */
        RevisionRequest: {
            /** Revision */
            revision: number;
            proposal: components["schemas"]["ProposalRequest"];
        };
        /**
         * Role
         * @description What a channel is to the identification.
         * @enum {string}
         */
        Role: "input" | "output" | "command" | "condition";
        /**
         * Row
         * @description One derivative; ``values`` follow the order of the sources, None where one has no say.
         *
         *     ``max_difference_sigma`` is the largest |a - b| / sqrt(sigma_a^2 + sigma_b^2) over
         *     pairs of runs with a standard error; ``consistent`` says that it is at most 2.
         *     ``mean`` is that of those runs, weighted by their errors, ``chi_square`` their
         *     scatter about it and ``probability`` that of a scatter at least as large. Predictions
         *     take no part: each is judged against the runs in its own value.
         */
        Row: {
            /** Name */
            name: string;
            /** Label */
            label: string;
            /** Values */
            values: (components["schemas"]["SourceValue"] | null)[];
            /** Consistent */
            consistent?: boolean | null;
            /** Max Difference Sigma */
            max_difference_sigma?: number | null;
            /** Mean */
            mean?: number | null;
            /** Mean Std Error */
            mean_std_error?: number | null;
            /** Chi Square */
            chi_square?: number | null;
            /** Probability */
            probability?: number | null;
        };
        /**
         * RulesHistory
         * @description Rules of review in force, and all of them, oldest first.
         */
        RulesHistory: {
            current: components["schemas"]["ReviewRules"];
            /** Items */
            items: components["schemas"]["ReviewRules"][];
        };
        /**
         * RulesRequest
         * @description Rules of review on top of ``version``, and why they change.
         */
        RulesRequest: {
            /** Quorum */
            quorum: number;
            /** Own Allowed */
            own_allowed: boolean;
            /** Version */
            version: number;
            /** Reason */
            reason: string;
        };
        /**
         * Run
         * @description An estimation run; ``parameters``, ``fit`` and ``poles`` are there once it succeeded.
         *
         *     ``altered`` means that the result, or what was asked for, does not match the hash that
         *     was kept with it; ``changed_since`` names data that were corrected since the run was
         *     computed, null where an earlier release did not record what it was computed from.
         *     ``repeated`` tells who asked for it that the same run had been asked for before.
         */
        Run: {
            /** Id */
            id: number;
            /** Maneuver Id */
            maneuver_id: number;
            method: components["schemas"]["Method"];
            state: components["schemas"]["RunState"];
            structure: components["schemas"]["Structure"];
            settings: components["schemas"]["RunSettings"];
            /** Modal Table Id */
            modal_table_id: number | null;
            /** Damping Table Id */
            damping_table_id: number | null;
            /** Prediction Id */
            prediction_id: number | null;
            /** Structure Id */
            structure_id: number | null;
            /** Structure Version */
            structure_version: number | null;
            /** Parameters */
            parameters: components["schemas"]["RunParameter"][];
            fit: components["schemas"]["Fit"] | null;
            /** Poles */
            poles: components["schemas"]["Pole"][];
            /** Blocks */
            blocks: components["schemas"]["RunBlock"][];
            /** Residualized Prediction */
            residualized_prediction: {
                [key: string]: number;
            } | null;
            error: components["schemas"]["RunError"] | null;
            progress: components["schemas"]["Progress"] | null;
            /** Versions */
            versions: {
                [key: string]: string;
            } | null;
            /** Attempt */
            attempt: number;
            /** Author */
            author: string;
            /**
             * Created At
             * Format: date-time
             */
            created_at: string;
            /** Started At */
            started_at: string | null;
            /** Finished At */
            finished_at: string | null;
            /** Deleted At */
            deleted_at: string | null;
            /** Priority */
            priority: number;
            limits: components["schemas"]["Limits"] | null;
            /** After Run Id */
            after_run_id: number | null;
            /** Data Hash */
            data_hash: string | null;
            /** Input Hash */
            input_hash: string | null;
            /** Worker */
            worker: string | null;
            /** Altered */
            altered: boolean;
            /** Changed Since */
            changed_since: string[] | null;
            proposal?: components["schemas"]["ProposalBasis"] | null;
            /** Repeated */
            repeated: boolean;
        };
        /**
         * RunBlock
         * @description One set of lines that was fitted.
         */
        RunBlock: {
            /** Name */
            name: string;
            /** Outputs */
            outputs: string[];
        };
        /**
         * RunError
         * @description Why a run failed.
         */
        RunError: {
            /** Code */
            code: string;
            /** Message */
            message: string;
        };
        /**
         * RunEvent
         * @description A line of the log of a run; ids grow, so that a reader can go on where it stopped.
         *
         *     ``kind`` is ``queued``, ``started``, ``said`` or the state that a run ended in.
         */
        RunEvent: {
            /** Id */
            id: number;
            /** Run Id */
            run_id: number;
            /**
             * At
             * Format: date-time
             */
            at: string;
            /** Kind */
            kind: string;
            /** Attempt */
            attempt: number;
            /**
             * Message
             * @default
             */
            message: string;
        };
        /**
         * RunExport
         * @description A run, what it rests on, and the arrays of its result as plain numbers.
         *
         *     ``covariance`` is ordered as the parameters; both are None and empty until
         *     the run has succeeded.
         */
        RunExport: {
            aircraft: components["schemas"]["Aircraft"];
            flight: components["schemas"]["Flight"];
            maneuver: components["schemas"]["Maneuver"];
            run: components["schemas"]["EstimationRun"];
            /** Covariance */
            covariance: number[][] | null;
            /** Lines */
            lines: components["schemas"]["ExportedLines"][];
        };
        /**
         * RunForecast
         * @description Flutter speed of one run, against the speed at which it was flown.
         *
         *     ``sentence`` says why there is none where it is None. ``separation`` is the lowest elastic over
         *     the short-period frequency there; None where the short period does not oscillate.
         */
        RunForecast: {
            /** Run Id */
            run_id: number;
            /** Label */
            label: string;
            /** Tested M S */
            tested_m_s: number;
            /** Airspeed M S */
            airspeed_m_s: number | null;
            /** Airspeed Std M S */
            airspeed_std_m_s: number | null;
            /** Sentence */
            sentence: string;
            /** Separation */
            separation: number | null;
        };
        /**
         * RunItem
         * @description One line of the list of runs.
         *
         *     ``worst_r_squared`` is that of the output fitted worst; ``has_model`` tells that the
         *     estimates make a whole model, which has poles.
         */
        RunItem: {
            /** Id */
            id: number;
            /** Maneuver Id */
            maneuver_id: number;
            /** Maneuver Label */
            maneuver_label: string;
            /** Flight Id */
            flight_id: number;
            /** Flight Number */
            flight_number: number;
            /** Aircraft Id */
            aircraft_id: number;
            /** Aircraft Name */
            aircraft_name: string;
            /** Fta */
            fta: number | null;
            /** Airspeed Ratio */
            airspeed_ratio: number | null;
            /** Dynamic Pressure Pa */
            dynamic_pressure_pa: number;
            /** Fuel Fraction */
            fuel_fraction: number;
            method: components["schemas"]["Method"];
            state: components["schemas"]["RunState"];
            /** Modes */
            modes: number[];
            /** Start */
            start: string;
            /** Prediction Id */
            prediction_id: number | null;
            /** Structure Id */
            structure_id: number | null;
            /** Structure Version */
            structure_version: number | null;
            /** Outcome */
            outcome: string | null;
            /** N Iterations */
            n_iterations: number | null;
            /** N Warnings */
            n_warnings: number | null;
            /** Worst R Squared */
            worst_r_squared: number | null;
            /** Has Model */
            has_model: boolean;
            /** Error Code */
            error_code: string | null;
            /** Author */
            author: string;
            /** Tags */
            tags: string[];
            /**
             * Created At
             * Format: date-time
             */
            created_at: string;
            /** Started At */
            started_at: string | null;
            /** Finished At */
            finished_at: string | null;
            /** Deleted At */
            deleted_at: string | null;
            /** Changed Since */
            changed_since: string[];
        };
        /**
         * RunList
         * @description A page of the filtered list of runs.
         */
        RunList: {
            /** Items */
            items: components["schemas"]["RunItem"][];
            /** Next */
            next?: string | null;
        };
        /**
         * RunParameter
         * @description An estimate with its label.
         *
         *     ``cramer_rao`` is the bound for white residuals, ``insensitivity`` the standard
         *     error that was left if all other parameters were known. ``no_error`` says why there is
         *     no standard error: the fit did not converge, or the parameter ended at its limit, or it is
         *     not identifiable.
         */
        RunParameter: {
            /** Name */
            name: string;
            /** Label */
            label: string;
            /** Value */
            value: number;
            /** Std Error */
            std_error: number | null;
            /** Start */
            start: number | null;
            /** Cramer Rao */
            cramer_rao: number | null;
            /** Insensitivity */
            insensitivity: number | null;
            /** No Error */
            no_error: string | null;
        };
        /**
         * RunProposal
         * @description Modes, inputs, outputs, band and options of a run, and what it asks of the data.
         *
         *     ``inputs`` and ``outputs`` are what the empty ones of the structure stand for;
         *     ``lines_per_parameter`` counts excited frequencies for each parameter of one equation.
         */
        RunProposal: {
            /** Maneuver Id */
            maneuver_id: number;
            basis: components["schemas"]["ProposalBasis"];
            structure: components["schemas"]["Structure"];
            settings: components["schemas"]["RunSettings"];
            /** Inputs */
            inputs: string[];
            /** Outputs */
            outputs: string[];
            /** Modes */
            modes: components["schemas"]["ModeInBand"][];
            /** N Parameters */
            n_parameters: number;
            /** N Lines */
            n_lines: number;
            /** Lines Per Input */
            lines_per_input: {
                [key: string]: number;
            };
            /** Lines Per Parameter */
            lines_per_parameter: number;
            /** Resolution Hz */
            resolution_hz: number;
            /** Warnings */
            warnings: string[];
        };
        /**
         * RunRequest
         * @description Estimate a model of one maneuver by one method.
         *
         *     What is left out is chosen: the aircraft's latest tables and the prediction
         *     that covers most of the derivatives. The structure is given in full, or by
         *     ``structure_id`` (in its newest version, else in ``structure_version``).
         */
        RunRequest: {
            /** Maneuver Id */
            maneuver_id: number;
            method: components["schemas"]["Method"];
            structure?: components["schemas"]["StructureRequest"] | null;
            settings?: components["schemas"]["SettingsRequest"] | null;
            /** Modal Table Id */
            modal_table_id?: number | null;
            /** Damping Table Id */
            damping_table_id?: number | null;
            /** Prediction Id */
            prediction_id?: number | null;
            /** Structure Id */
            structure_id?: number | null;
            /** Structure Version */
            structure_version?: number | null;
            /**
             * Author
             * @default
             */
            author: string;
            /**
             * Priority
             * @default 0
             */
            priority: number;
            limits?: components["schemas"]["LimitsRequest"] | null;
        };
        /**
         * RunResult
         * @description What a finished run keeps; ``covariance`` is a hash, ordered as ``parameters``.
         *
         *     ``prediction_id`` is the prediction that was used, chosen or found; ``held`` are
         *     the derivatives that were not free, at the values they were held at.
         */
        RunResult: {
            /** Parameters */
            parameters: components["schemas"]["ParameterEstimate"][];
            /** Covariance */
            covariance: string;
            fit: components["schemas"]["Fit"];
            /** Poles */
            poles: components["schemas"]["Pole"][];
            /** Blocks */
            blocks: components["schemas"]["FitBlock"][];
            /** Residualized Prediction */
            residualized_prediction?: {
                [key: string]: number;
            } | null;
            /** Prediction Id */
            prediction_id?: number | null;
            /** Held */
            held?: {
                [key: string]: number;
            };
        };
        /**
         * RunSettings
         * @description Choices of the analyst that are not model structure.
         *
         *     ``noise`` is ``diagonal`` or ``full``; ``priors`` gives value and standard
         *     deviation by parameter, ``prior_spread`` gives every free derivative a prior at
         *     the prediction with this share of its size; ``start_run_id`` goes with the start ``run``;
         *     ``together_with`` names further maneuvers fitted with the same derivatives.
         */
        RunSettings: {
            /** @default best */
            start: components["schemas"]["Start"];
            /** Band Hz */
            band_hz?: [
                number,
                number
            ] | null;
            /**
             * Max Iterations
             * @default 100
             */
            max_iterations: number;
            /**
             * Noise
             * @default diagonal
             */
            noise: string;
            /** Priors */
            priors?: {
                [key: string]: [
                    number,
                    number
                ];
            };
            /** Prior Spread */
            prior_spread?: number | null;
            /** Start Run Id */
            start_run_id?: number | null;
            /**
             * Together With
             * @default []
             */
            together_with: number[];
        };
        /**
         * RunState
         * @description Life of a run; the run table is the job queue.
         * @enum {string}
         */
        RunState: "queued" | "running" | "succeeded" | "failed" | "cancelled";
        /**
         * SavedView
         * @description ``search`` is the part of the page's address that says what is shown.
         */
        SavedView: {
            /** Page */
            page: string;
            /** Name */
            name: string;
            /** Search */
            search: string;
            /**
             * Author
             * @default
             */
            author: string;
            /** Created At */
            created_at?: string | null;
            /** Id */
            id?: number | null;
        };
        /**
         * SavedViewList
         * @description Saved views of a page, or of all.
         */
        SavedViewList: {
            /** Items */
            items: components["schemas"]["SavedView"][];
        };
        /**
         * SavedViewRequest
         * @description Keep what a page shows under a name.
         */
        SavedViewRequest: {
            /**
             * Page
             * @enum {string}
             */
            page: "campaign" | "runs" | "compare" | "flutter";
            /** Name */
            name: string;
            /** Search */
            search: string;
            /**
             * Author
             * @default
             */
            author: string;
        };
        /**
         * SearchCandidate
         * @description A structure on the way, fitted.
         *
         *     ``predictive_cost`` is the negative log likelihood of all lines it did not see, None
         *     where it predicts nothing finite; ``run_id`` is the run that opened it.
         */
        SearchCandidate: {
            /** Name */
            name: string;
            /** Why */
            why: string;
            structure: components["schemas"]["Structure"];
            /** N Terms */
            n_terms: number;
            /** Proposed */
            proposed: boolean;
            /** Converged */
            converged: boolean;
            /** Cost */
            cost: number | null;
            /** Bic */
            bic: number | null;
            /** Likelihood Ratio */
            likelihood_ratio: number | null;
            /** Foretold */
            foretold: number | null;
            /** Predicted */
            predicted: components["schemas"]["PredictedLines"][];
            /** Predictive Cost */
            predictive_cost: number | null;
            /** Flutter M S */
            flutter_m_s: number | null;
            /** Flutter Std M S */
            flutter_std_m_s: number | null;
            /** Flutter */
            flutter: string;
            /** Run Id */
            run_id?: number | null;
        };
        /**
         * SearchItem
         * @description One line of the list: a search without what it found.
         */
        SearchItem: {
            /** Id */
            id: number;
            /** Aircraft Id */
            aircraft_id: number;
            /** Maneuver Ids */
            maneuver_ids: number[];
            method: components["schemas"]["Method"];
            /** Modes */
            modes: number[];
            state: components["schemas"]["RunState"];
            /** Sentence */
            sentence: string | null;
            /** Author */
            author: string;
            /** Created At */
            created_at: string | null;
        };
        /**
         * SearchList
         * @description Searches, newest first.
         */
        SearchList: {
            /** Items */
            items: components["schemas"]["SearchItem"][];
        };
        /**
         * SearchRequest
         * @description Maneuvers to search over, and a structure whose free derivatives are the candidates.
         */
        SearchRequest: {
            /** Maneuver Ids */
            maneuver_ids: number[];
            method: components["schemas"]["Method"];
            structure: components["schemas"]["StructureRequest"];
            /**
             * @default {
             *       "algorithm": "stepwise",
             *       "begin": "all",
             *       "f_in": 20,
             *       "f_out": 20,
             *       "pse_noise": 25,
             *       "draws": 30,
             *       "validate_on": [],
             *       "max_iterations": 100,
             *       "noise": "diagonal"
             *     }
             */
            settings: components["schemas"]["SearchSettingsRequest"];
            /** Modal Table Id */
            modal_table_id?: number | null;
            /** Damping Table Id */
            damping_table_id?: number | null;
            /** Prediction Id */
            prediction_id?: number | null;
        };
        /**
         * SearchResult
         * @description What a search found; candidates stand in the order of their predictive likelihood.
         */
        SearchResult: {
            /** Sentence */
            sentence: string;
            /** Groups */
            groups: components["schemas"]["TermGroup"][];
            /** Candidates */
            candidates: components["schemas"]["SearchCandidate"][];
            /** Warnings */
            warnings: string[];
            /** Seconds */
            seconds: number;
        };
        /**
         * SearchSettings
         * @description What a term must show, and how that is tried.
         *
         *     ``f_in`` and ``f_out`` bound the partial F to enter and to stay; ``pse_noise`` is how
         *     many noise variances the predicted squared error charges for a term; ``draws`` is how
         *     often lines are drawn anew; ``validate_on`` names maneuvers that are only predicted.
         */
        SearchSettings: {
            /** @default stepwise */
            algorithm: components["schemas"]["Algorithm"];
            /** @default all */
            begin: components["schemas"]["SearchStart"];
            /**
             * F In
             * @default 20
             */
            f_in: number;
            /**
             * F Out
             * @default 20
             */
            f_out: number;
            /**
             * Pse Noise
             * @default 25
             */
            pse_noise: number;
            /**
             * Draws
             * @default 30
             */
            draws: number;
            /**
             * Validate On
             * @default []
             */
            validate_on: number[];
            /** Band Hz */
            band_hz?: [
                number,
                number
            ] | null;
            /**
             * Max Iterations
             * @default 100
             */
            max_iterations: number;
            /**
             * Noise
             * @default diagonal
             */
            noise: string;
        };
        /**
         * SearchSettingsRequest
         * @description What a term must show, and how that is tried; see ``SearchSettings``.
         */
        SearchSettingsRequest: {
            /** @default stepwise */
            algorithm: components["schemas"]["Algorithm"];
            /** @default all */
            begin: components["schemas"]["SearchStart"];
            /**
             * F In
             * @default 20
             */
            f_in: number;
            /**
             * F Out
             * @default 20
             */
            f_out: number;
            /**
             * Pse Noise
             * @default 25
             */
            pse_noise: number;
            /**
             * Draws
             * @default 30
             */
            draws: number;
            /**
             * Validate On
             * @default []
             */
            validate_on: number[];
            /** Band Hz */
            band_hz?: [
                number,
                number
            ] | null;
            /**
             * Max Iterations
             * @default 100
             */
            max_iterations: number;
            /**
             * Noise
             * @default diagonal
             * @enum {string}
             */
            noise: "diagonal" | "full";
        };
        /**
         * SearchStart
         * @description What output error and frequency response error begin with.
         * @enum {string}
         */
        SearchStart: "all" | "equation error";
        /**
         * SearchStep
         * @description One term in or out, its partial F, and the criteria after it.
         */
        SearchStep: {
            /** Action */
            action: string;
            /** Term */
            term: string;
            /** F */
            f: number;
            /** N Terms */
            n_terms: number;
            /** R Squared */
            r_squared: number | null;
            /** Pse */
            pse: number | null;
            /** Bic */
            bic: number | null;
        };
        /**
         * SearchTerm
         * @description One candidate term at the end.
         *
         *     ``value`` is what it has, or would take as the next to enter; None where the others say
         *     the same. ``support`` is the share of maneuvers that ask for it alone, ``stability`` the
         *     share of draws of the lines that choose it, ``inflation`` its variance inflation among
         *     all candidates (None: infinite).
         */
        SearchTerm: {
            /** Name */
            name: string;
            /** Chosen */
            chosen: boolean;
            /** Value */
            value: number | null;
            /** Std Error */
            std_error: number | null;
            /** F */
            f: number;
            /** Support */
            support: number;
            /** Stability */
            stability: number | null;
            /** Inflation */
            inflation: number | null;
        };
        /**
         * SecondOrder
         * @description Sensor with unit static gain: wn^2 / (s^2 + 2 zeta wn s + wn^2).
         */
        SecondOrder: {
            /** Natural Frequency */
            natural_frequency: number;
            /** Damping */
            damping: number;
        };
        /**
         * Sensor
         * @description One sensor: what it measures, where it sits, through which instrument.
         *
         *     ``point`` names a row of the modal table's ``points`` (``gauges`` for a
         *     strain gauge). Locations are in structural axes: x aft, y right, z up [m].
         *     ``noise_std`` is in the SI unit of the channel.
         */
        Sensor: {
            /** Name */
            name: string;
            kind: components["schemas"]["SensorKind"];
            /** Point */
            point: string;
            /**
             * Axis
             * @default z
             */
            axis: string;
            /**
             * Location M
             * @default [
             *       0,
             *       0,
             *       0
             *     ]
             */
            location_m: [
                number,
                number,
                number
            ];
            /** Instrument */
            instrument?: string | null;
            /** Noise Std */
            noise_std?: number | null;
        };
        /**
         * SensorKind
         * @description What a sensor measures; decides its row in the output equations.
         * @enum {string}
         */
        SensorKind: "accelerometer" | "gyro" | "attitude" | "vane" | "strain";
        /**
         * SensorRow
         * @description How much of each mode one sensor sees: share of the largest motion of that kind.
         */
        SensorRow: {
            /** Sensor */
            sensor: string;
            /** Kind */
            kind: string;
            /** Axis */
            axis: string;
            /** Share */
            share: (number | null)[];
        };
        /**
         * SensorSight
         * @description What one sensor sees of one mode: its place, its motion there, and its signal.
         */
        SensorSight: {
            /** Sensor */
            sensor: string;
            /** Kind */
            kind: string;
            /** Axis */
            axis: string;
            /** Place M */
            place_m: [
                number,
                number,
                number
            ];
            /** Phi M */
            phi_m: [
                number,
                number,
                number
            ];
            /** Nu Rad */
            nu_rad: [
                number,
                number,
                number
            ];
        };
        /**
         * SettingsRequest
         * @description Choices of the analyst that are not model structure.
         */
        SettingsRequest: {
            /** @default best */
            start: components["schemas"]["Start"];
            /** Band Hz */
            band_hz?: [
                number,
                number
            ] | null;
            /**
             * Max Iterations
             * @default 100
             */
            max_iterations: number;
            /**
             * Noise
             * @default diagonal
             * @enum {string}
             */
            noise: "diagonal" | "full";
            /** Priors */
            priors?: {
                [key: string]: [
                    number,
                    number
                ];
            } | null;
            /** Prior Spread */
            prior_spread?: number | null;
            /** Start Run Id */
            start_run_id?: number | null;
            /**
             * Together With
             * @default []
             */
            together_with: number[];
        };
        /**
         * Setup
         * @description A choice of the analyst in which the runs differ; values in the order of the sources.
         */
        Setup: {
            /** Name */
            name: string;
            /** Values */
            values: (string | null)[];
        };
        /**
         * ShapeAnswer
         * @description One mode as it is drawn; see ``DrawnShape``.
         */
        ShapeAnswer: {
            /** Modal Table Id */
            modal_table_id: number;
            /** Number */
            number: number;
            /** Name */
            name: string;
            /** Fuel */
            fuel: number;
            /** Frequency Hz */
            frequency_hz: number;
            /** N Nodes */
            n_nodes: number;
            /** Nodes M */
            nodes_m: [
                number,
                number,
                number
            ][];
            /** Displacement M */
            displacement_m: [
                number,
                number,
                number
            ][];
            /** Lines */
            lines: [
                number,
                number
            ][];
            /** Largest M */
            largest_m: number;
            /** Span M */
            span_m: number;
            /** Sensors */
            sensors: components["schemas"]["SensorSight"][];
        };
        /**
         * Source
         * @description One column of a comparison; ``kind`` is OE, FRE, EE or prediction.
         *
         *     ``changed_since`` names data of a run that were corrected after it was computed.
         */
        Source: {
            /** Key */
            key: string;
            /** Label */
            label: string;
            /** Kind */
            kind: string;
            /** Run Id */
            run_id?: number | null;
            /** Prediction Id */
            prediction_id?: number | null;
            /**
             * Changed Since
             * @default []
             */
            changed_since: string[];
        };
        /**
         * SourceValue
         * @description What one source says about a derivative; ``std_error`` is None where it gives none.
         *
         *     Of a prediction, ``difference_sigma`` is the largest |prediction - run| over the runs, in
         *     combined standard errors, and ``consistent`` whether that is at most 2; None of a run, and
         *     where one of the two has no standard error.
         */
        SourceValue: {
            /** Key */
            key: string;
            /** Value */
            value: number;
            /** Std Error */
            std_error?: number | null;
            /** Difference Sigma */
            difference_sigma?: number | null;
            /** Consistent */
            consistent?: boolean | null;
        };
        /**
         * StaleProposal
         * @description Why a vote or revision was refused: ``current`` stands in the place of ``base`` by now.
         */
        StaleProposal: {
            /** Type */
            type: string;
            /** Title */
            title: string;
            /** Status */
            status: number;
            /** Detail */
            detail: string;
            /** Code */
            code: string;
            /** Errors */
            errors?: components["schemas"]["FieldError"][] | null;
            base: components["schemas"]["StructureProposal"];
            current: components["schemas"]["StructureProposal"];
            sent: components["schemas"]["StructureProposal"] | null;
            /** Revision */
            revision: number;
        };
        /**
         * StaleStructure
         * @description Why an edit was refused, with all that is needed to make it again.
         *
         *     ``base`` was edited into ``sent``, while ``current`` became the newest version.
         */
        StaleStructure: {
            /** Type */
            type: string;
            /** Title */
            title: string;
            /** Status */
            status: number;
            /** Detail */
            detail: string;
            /** Code */
            code: string;
            base: components["schemas"]["StructureVersion"];
            current: components["schemas"]["StructureVersion"];
            sent: components["schemas"]["StructureVersion"];
        };
        /**
         * Start
         * @description Where the iteration starts; ``best`` takes whichever candidate is likeliest.
         * @enum {string}
         */
        Start: "best" | "prediction" | "residualized-prediction" | "equation-error" | "run";
        /**
         * StepKind
         * @description What a step corrects.
         * @enum {string}
         */
        StepKind: "delay" | "calibration" | "repair";
        /**
         * StepRequest
         * @description One correction; see ``Correction``.
         */
        StepRequest: {
            /** Channel */
            channel: string;
            kind: components["schemas"]["StepKind"];
            /**
             * Delay S
             * @default 0
             */
            delay_s: number;
            /**
             * Scale
             * @default 1
             */
            scale: number;
            /**
             * Bias
             * @default 0
             */
            bias: number;
            /**
             * Stretches
             * @default []
             */
            stretches: [
                number,
                number
            ][];
            /** Std */
            std?: number | null;
            /**
             * Basis
             * @default
             */
            basis: string;
        };
        /**
         * StoredMapping
         * @description A mapping under a name; ``text`` is the TOML as it was written.
         */
        StoredMapping: {
            /** Name */
            name: string;
            /** Text */
            text: string;
            /**
             * Note
             * @default
             */
            note: string;
            /** Created At */
            created_at?: string | null;
            /** Id */
            id?: number | null;
        };
        /**
         * Structure
         * @description The content of a model structure; a run keeps its own copy.
         *
         *     Empty ``inputs`` or ``outputs`` stand for all that the maneuver has. Each
         *     derivative of the chosen modes and inputs is in one state:
         *
         *     - absent, where ``absent`` names it: the model does not have it, it is zero;
         *     - fixed to a number (``fixed``), to a prediction or an earlier run
         *       (``fixed_to``), or, where ``free`` leaves it out, to the start of the run;
         *     - free otherwise; ``free`` of None frees all that is neither absent nor fixed.
         *
         *     ``delays`` [s] of outputs and inputs add to those of their instruments, and
         *     ``instruments`` puts another of the aircraft's instruments (None: none at all)
         *     behind a channel; a combination stands for its sensors.
         */
        Structure: {
            /**
             * Modes
             * @default []
             */
            modes: number[];
            /**
             * Inputs
             * @default []
             */
            inputs: string[];
            /**
             * Outputs
             * @default []
             */
            outputs: string[];
            /** Free */
            free?: string[] | null;
            /** Fixed */
            fixed: {
                [key: string]: number;
            };
            /**
             * Free Delays
             * @default false
             */
            free_delays: boolean;
            /**
             * Also Free
             * @default []
             */
            also_free: string[];
            /**
             * Axis
             * @default longitudinal
             */
            axis: string;
            /**
             * Absent
             * @default []
             */
            absent: string[];
            /** Fixed To */
            fixed_to?: {
                [key: string]: components["schemas"]["FixedTo"];
            };
            /** Delays */
            delays?: {
                [key: string]: number;
            };
            /** Instruments */
            instruments?: {
                [key: string]: string | null;
            };
        };
        /**
         * StructureEditRequest
         * @description Keep a new version of a model structure.
         *
         *     ``version`` is the one that was edited; the header ``If-Match`` says the same.
         */
        StructureEditRequest: {
            /** Name */
            name: string;
            structure: components["schemas"]["StructureRequest"];
            /**
             * Note
             * @default
             */
            note: string;
            /** Version */
            version?: number | null;
        };
        /**
         * StructureFilesRequest
         * @description What an analyst says of uploaded files; see ``StructureAnswers``.
         */
        StructureFilesRequest: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Name */
            name: string;
            /** @default FEM */
            kind: components["schemas"]["ModalKind"];
            /** Length Unit */
            length_unit?: ("m" | "mm" | "in" | "ft") | null;
            /** Mass Unit */
            mass_unit?: ("kg" | "t" | "lb" | "slug" | "slinch") | null;
            /** Generalized Mass */
            generalized_mass?: ("file" | "unit" | "unknown") | null;
            /**
             * Axes
             * @default aft right up
             */
            axes: string;
            /**
             * Origin
             * @default [
             *       0,
             *       0,
             *       0
             *     ]
             */
            origin: [
                number,
                number,
                number
            ];
            /** Fuel */
            fuel?: {
                [key: string]: number;
            };
            /**
             * Rigid Modes
             * @default false
             */
            rigid_modes: boolean;
            /** Points */
            points?: {
                [key: string]: number;
            };
        };
        /**
         * StructureForecast
         * @description Flutter speed of all runs of one model structure, fused.
         *
         *     ``held_modes`` carry predicted derivatives only, ``source`` names the prediction where they
         *     were carried in a second fit; ``left_out_modes`` are known to a prediction but not to the
         *     model, whose derivatives hold their static response. ``check`` is a second fit with one mode
         *     fewer, of which half of the difference counts. ``airspeed_m_s`` is None where the model stays
         *     stable, or flight contradicts it; ``airspeed_std_m_s`` counts the modal frequencies too.
         */
        StructureForecast: {
            /** Run Ids */
            run_ids: number[];
            /** Modes */
            modes: number[];
            /** Held Modes */
            held_modes: number[];
            /** Left Out Modes */
            left_out_modes: number[];
            /** Source */
            source: string | null;
            /** Airspeed M S */
            airspeed_m_s: number | null;
            /** Airspeed Std M S */
            airspeed_std_m_s: number | null;
            /** Frequency Rad S */
            frequency_rad_s: number | null;
            /** Sentence */
            sentence: string;
            /** Preferred */
            preferred: boolean;
            /**
             * Check
             * @default false
             */
            check: boolean;
        };
        /**
         * StructureFound
         * @description What the files of a structure hold, and what has to be asked.
         */
        StructureFound: {
            /** Files */
            files: components["schemas"]["flexsid__importers__structure__found__FoundFile"][];
            /** Frequencies Hz */
            frequencies_hz: number[];
            /** N Nodes */
            n_nodes: number;
            /** Questions */
            questions: components["schemas"]["Question"][];
        };
        /**
         * StructureProposal
         * @description What a decision is about, and the evidence for it.
         *
         *     ``changes`` is the version that ``structure`` changes, where it is not new.
         */
        StructureProposal: {
            /** Title */
            title: string;
            structure: components["schemas"]["StructureReference"];
            changes?: components["schemas"]["StructureReference"] | null;
            /** Limits */
            limits: {
                [key: string]: [
                    number,
                    number
                ];
            };
            /** Reasoning */
            reasoning: string;
            /**
             * Run Ids
             * @default []
             */
            run_ids: number[];
            /**
             * Comparisons
             * @default []
             */
            comparisons: components["schemas"]["LinkedComparison"][];
            /**
             * Figure Ids
             * @default []
             */
            figure_ids: number[];
        };
        /**
         * StructureReference
         * @description One version of one model structure.
         */
        StructureReference: {
            /** Id */
            id: number;
            /** Version */
            version: number;
        };
        /**
         * StructureRequest
         * @description A model structure; see ``Structure``.
         */
        StructureRequest: {
            /**
             * Modes
             * @default []
             */
            modes: number[];
            /**
             * Inputs
             * @default []
             */
            inputs: string[];
            /**
             * Outputs
             * @default []
             */
            outputs: string[];
            /** Free */
            free?: string[] | null;
            /** Fixed */
            fixed?: {
                [key: string]: number;
            } | null;
            /**
             * Free Delays
             * @default false
             */
            free_delays: boolean;
            /**
             * Also Free
             * @default []
             */
            also_free: string[];
            /**
             * Axis
             * @default longitudinal
             * @constant
             */
            axis: "longitudinal";
            /**
             * Absent
             * @default []
             */
            absent: string[];
            /** Fixed To */
            fixed_to?: {
                [key: string]: components["schemas"]["FixedToRequest"];
            } | null;
            /** Delays */
            delays?: {
                [key: string]: number;
            } | null;
            /** Instruments */
            instruments?: {
                [key: string]: string | null;
            } | null;
        };
        /**
         * StructureSearch
         * @description A search that was asked for and, once done, its result.
         *
         *     What ``structure`` frees are the candidates; what it fixes or leaves out stays so.
         */
        StructureSearch: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Maneuver Ids */
            maneuver_ids: number[];
            method: components["schemas"]["Method"];
            structure: components["schemas"]["Structure"];
            settings: components["schemas"]["SearchSettings"];
            /** Modal Table Id */
            modal_table_id?: number | null;
            /** Damping Table Id */
            damping_table_id?: number | null;
            /** Prediction Id */
            prediction_id?: number | null;
            /** @default queued */
            state: components["schemas"]["RunState"];
            progress?: components["schemas"]["Progress"] | null;
            /** Error */
            error?: {
                [key: string]: string;
            } | null;
            result?: components["schemas"]["SearchResult"] | null;
            /** Versions */
            versions?: {
                [key: string]: string;
            } | null;
            /**
             * Author
             * @default
             */
            author: string;
            /** Created At */
            created_at?: string | null;
            /** Finished At */
            finished_at?: string | null;
            /** Id */
            id?: number | null;
        };
        /**
         * StructureVersion
         * @description One version of a model structure; it is written once and never changed.
         */
        StructureVersion: {
            /** Structure Id */
            structure_id: number;
            /** Version */
            version: number;
            /** Name */
            name: string;
            structure: components["schemas"]["Structure"];
            /** Note */
            note: string;
            /** Author */
            author: string;
            /** Created At */
            created_at?: string | null;
            /** Id */
            id?: number | null;
        };
        /**
         * StructureVersionList
         * @description Versions of a model structure, oldest first.
         */
        StructureVersionList: {
            /** Items */
            items: components["schemas"]["StructureVersion"][];
        };
        /**
         * Surface
         * @description A control surface, or a pair moved as one.
         *
         *     ``symmetry`` of None leaves it to the name; see ``symmetry_of``. ``instrument`` lies
         *     between the true deflection and its recording. Where the command was recorded instead,
         *     ``actuator`` turns it into the true deflection. ``servo`` lies between command and
         *     deflection where both were recorded; control loops are broken in front of it.
         */
        Surface: {
            /** Name */
            name: string;
            /** Instrument */
            instrument?: string | null;
            /** Actuator */
            actuator?: string | null;
            /** Servo */
            servo?: string | null;
            /** Noise Std Rad */
            noise_std_rad?: number | null;
            /** Symmetry */
            symmetry?: ("symmetric" | "antisymmetric" | "single") | null;
        };
        /**
         * TargetMode
         * @description A structural mode that a design targets, with its frequencies over fuel. [Hz]
         *
         *     ``group`` is LE or HE of Table 1, or "all" for a design that is no row of it.
         */
        TargetMode: {
            /** Number */
            number: number;
            /** Name */
            name: string;
            /** Group */
            group: string;
            /** Low Hz */
            low_hz: number;
            /** High Hz */
            high_hz: number;
            /** In Band */
            in_band: boolean;
        };
        /**
         * TargetModes
         * @description The band of a design [Hz] and the structural modes it targets; ``sentence`` compares them.
         */
        TargetModes: {
            /** Low Hz */
            low_hz: number;
            /** High Hz */
            high_hz: number;
            /** Modes */
            modes: components["schemas"]["TargetMode"][];
            /** Sentence */
            sentence: string;
        };
        /**
         * Task
         * @description How far a task is; ``made`` is the id of the record that it kept.
         */
        Task: {
            /** Id */
            id: string;
            /** Kind */
            kind: string;
            /** Title */
            title: string;
            /**
             * Begun At
             * Format: date-time
             */
            begun_at: string;
            /** Ended At */
            ended_at?: string | null;
            /** @default waiting */
            state: components["schemas"]["TaskState"];
            /**
             * Fraction
             * @default 0
             */
            fraction: number;
            /**
             * Message
             * @default
             */
            message: string;
            /**
             * Code
             * @default
             */
            code: string;
            /** Made */
            made?: number | null;
        };
        /**
         * TaskList
         * @description Tasks of this server since it was started.
         */
        TaskList: {
            /** Items */
            items: components["schemas"]["Task"][];
        };
        /**
         * TaskState
         * @description Life of a task; it ends with the server, what it has made does not.
         * @enum {string}
         */
        TaskState: "waiting" | "running" | "done" | "failed" | "cancelled";
        /**
         * TermDependency
         * @description Terms that the data hardly tell apart, by their share in a weak direction.
         */
        TermDependency: {
            /** Condition Index */
            condition_index: number;
            /** Shares */
            shares: {
                [key: string]: number;
            };
        };
        /**
         * TermGroup
         * @description Terms that were searched together: of one coefficient by EE, of the model by OE or FRE.
         */
        TermGroup: {
            /** Name */
            name: string;
            /** Path */
            path: components["schemas"]["SearchStep"][];
            /** Terms */
            terms: components["schemas"]["SearchTerm"][];
            /** Dependencies */
            dependencies: components["schemas"]["TermDependency"][];
            /** R Squared */
            r_squared: number | null;
            /** Pse */
            pse: number | null;
            /** Bic */
            bic: number | null;
        };
        /**
         * ThrustRequest
         * @description Thrust of one engine as a table of text, and the channels of the rotation speeds.
         *
         *     The first row has a label and total temperatures; every other row has a rotation speed,
         *     then thrust. Without temperatures, two columns are enough.
         */
        ThrustRequest: {
            /** Engines */
            engines: string[];
            /** Text */
            text: string;
            /**
             * Speed Unit
             * @default rpm
             */
            speed_unit: string;
            /**
             * Temperature Unit
             * @default K
             */
            temperature_unit: string;
            /**
             * Thrust Unit
             * @default N
             */
            thrust_unit: string;
            /**
             * Source
             * @default
             */
            source: string;
        };
        /**
         * ThrustTable
         * @description Thrust of one engine, as a ground test told it, against the state of the engine.
         *
         *     ``engines`` are the condition channels of the rotation speeds, one for each engine.
         *     ``thrust_n`` has a row for every rotation speed and a column for every total temperature
         *     of the air; one temperature alone means that thrust does not depend on it.
         */
        ThrustTable: {
            /** Engines */
            engines: string[];
            /** Engine Speed Rad S */
            engine_speed_rad_s: number[];
            /** Total Temperature K */
            total_temperature_k: number[];
            /** Thrust N */
            thrust_n: number[][];
            /**
             * Source
             * @default
             */
            source: string;
        };
        /**
         * TrackerForecast
         * @description What a classical tracker extrapolates from the same runs, or why it cannot.
         */
        TrackerForecast: {
            /** Name */
            name: string;
            /** Airspeed M S */
            airspeed_m_s: number | null;
            /** Sentence */
            sentence: string;
        };
        /**
         * TrendLine
         * @description A weighted fit through the estimates of one method, or a prediction joined up.
         *
         *     ``std_errors`` are None for a prediction. ``probability`` is that of a scatter
         *     about the fit at least as large as found.
         */
        TrendLine: {
            /** Label */
            label: string;
            /** Kind */
            kind: string;
            /** X */
            x: number[];
            /** Values */
            values: number[];
            /** Std Errors */
            std_errors?: number[] | null;
            /** Slope */
            slope?: number | null;
            /** Slope Std Error */
            slope_std_error?: number | null;
            /** Chi Square */
            chi_square?: number | null;
            /** Freedom */
            freedom?: number | null;
            /** Probability */
            probability?: number | null;
        };
        /**
         * TrendPoint
         * @description One estimate at one condition; ``x`` in SI, a fraction, or the number of the FTA.
         */
        TrendPoint: {
            /** Run Id */
            run_id: number;
            /** Maneuver Id */
            maneuver_id: number;
            /** Label */
            label: string;
            /** Kind */
            kind: string;
            /** X */
            x: number;
            /** Value */
            value: number;
            /** Std Error */
            std_error: number | null;
        };
        /**
         * Upload
         * @description An upload and what became of it; ``progress`` is the fraction that is written.
         */
        Upload: {
            /** Id */
            id: string;
            /** @default read */
            state: components["schemas"]["UploadState"];
            /** Progress */
            progress?: number | null;
            /** Code */
            code?: string | null;
            /** Message */
            message?: string | null;
            /** Maneuver Id */
            maneuver_id?: number | null;
            /** Flight Id */
            flight_id?: number | null;
            /** N Channels */
            n_channels?: number | null;
        };
        /**
         * UploadDetail
         * @description An upload with what its files hold and a mapping proposed for them.
         */
        UploadDetail: {
            upload: components["schemas"]["Upload"];
            /** Files */
            files: components["schemas"]["flexsid__workflow__describing__FoundFile"][];
            /** Fields */
            fields: components["schemas"]["FoundField"][];
            proposal: components["schemas"]["Proposal"];
        };
        /**
         * UploadList
         * @description Uploads that are being imported.
         */
        UploadList: {
            /** Items */
            items: components["schemas"]["Upload"][];
        };
        /**
         * UploadMappingRequest
         * @description A mapping, as TOML, for the files of an upload; ``confirmed``: its guesses are right.
         */
        UploadMappingRequest: {
            /** Mapping */
            mapping: string;
            /** Aircraft Id */
            aircraft_id?: number | null;
            /**
             * Confirmed
             * @default false
             */
            confirmed: boolean;
        };
        /**
         * UploadState
         * @description How far an upload has come.
         * @enum {string}
         */
        UploadState: "read" | "importing" | "imported" | "failed";
        /**
         * Vote
         * @description What a reviewer says of a proposal.
         * @enum {string}
         */
        Vote: "approve" | "request-changes" | "reject";
        /**
         * VoteRequest
         * @description A vote on ``revision``, and why.
         */
        VoteRequest: {
            /** Revision */
            revision: number;
            vote: components["schemas"]["Vote"];
            /** Text */
            text: string;
        };
        /**
         * Waiting
         * @description A decision that cannot go on without this analyst; ``what`` is review or revise.
         */
        Waiting: {
            /** Decision Id */
            decision_id: number;
            /** Title */
            title: string;
            /** What */
            what: string;
            /** Revision */
            revision: number;
            /** Since */
            since: string | null;
        };
        /**
         * Wish
         * @description What is wanted of a design; with its phases, the whole recipe.
         *
         *     ``peaks`` are the largest deflections of an input with relative peak 1 at the
         *     three amplitudes, low to high, in the unit of the command.
         */
        Wish: {
            /** Duration S */
            duration_s: number;
            /** Rate Hz */
            rate_hz: number;
            /** Inputs */
            inputs: components["schemas"]["InputWish"][];
            /** Peaks */
            peaks: [
                number,
                number,
                number
            ];
            /**
             * Effort
             * @default thorough
             */
            effort: string;
            /**
             * Seed
             * @default 0
             */
            seed: number;
        };
        /**
         * WithdrawalRequest
         * @description Why ``revision`` is taken back.
         */
        WithdrawalRequest: {
            /** Revision */
            revision: number;
            /** Text */
            text: string;
        };
        /**
         * Problem
         * @description Why a request was not carried out; ``code`` is stable, ``detail`` is for people.
         */
        flexsid__api__errors__Problem: {
            /** Type */
            type: string;
            /** Title */
            title: string;
            /** Status */
            status: number;
            /** Detail */
            detail: string;
            /** Code */
            code: string;
            /** Errors */
            errors?: components["schemas"]["FieldError"][] | null;
        };
        /**
         * FoundFile
         * @description One file: what it holds, in words, and the data sets of it that are not used.
         */
        flexsid__importers__structure__found__FoundFile: {
            /** Name */
            name: string;
            /** Holds */
            holds: string[];
            /** Refused */
            refused: string[];
            /** Has Modes */
            has_modes: boolean;
        };
        /**
         * Verdict
         * @description How many of the derivatives that can be judged agree within 2 combined standard errors.
         *
         *     ``source`` is the key of the prediction that is judged against the runs; None of the runs
         *     judged among each other.
         */
        flexsid__records__comparison__Verdict: {
            /** Source */
            source?: string | null;
            /**
             * N Judged
             * @default 0
             */
            n_judged: number;
            /**
             * N Consistent
             * @default 0
             */
            n_consistent: number;
        };
        /**
         * Verdict
         * @description What a pair of ground records says of the structure.
         * @enum {string}
         */
        flexsid__records__ground_test__Verdict: "healthy" | "watch" | "alarm";
        /**
         * Verdict
         * @description Whether a maneuver may be estimated from; ``unchecked`` where this cannot be concluded.
         * @enum {string}
         */
        flexsid__records__quality__Verdict: "good" | "doubtful" | "bad" | "unchecked";
        /**
         * FoundFile
         * @description One file of an upload.
         */
        flexsid__workflow__describing__FoundFile: {
            /** Name */
            name: string;
            /** Sha256 */
            sha256: string;
            /** N Fields */
            n_fields: number;
        };
        /**
         * Problem
         * @description Why a mapping does not do yet; ``key`` is its key or the channel meant.
         */
        flexsid__workflow__describing__Problem: {
            /** Code */
            code: string;
            /** Message */
            message: string;
            /** Key */
            key: string | null;
        };
    };
    responses: never;
    parameters: never;
    requestBodies: never;
    headers: never;
    pathItems: never;
}
export type $defs = Record<string, never>;
export interface operations {
    get_health: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Health"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    list_aircraft: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["AircraftList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_aircraft: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                aircraft_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Aircraft"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    set_thrust: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                aircraft_id: number;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["ThrustRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Aircraft"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    remove_thrust: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                aircraft_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Aircraft"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    list_flights: {
        parameters: {
            query?: {
                aircraft_id?: number | null;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["FlightList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_flight: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                flight_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Flight"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    list_flight_channels: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                flight_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["FlightChannelList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    find_maneuvers: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                flight_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["FoundManeuverList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    cut_maneuver: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                flight_id: number;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["CutRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ManeuverDetail"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    list_ground_tests: {
        parameters: {
            query?: {
                aircraft_id?: number | null;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["GroundTestList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_ground_test: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                flight_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["GroundTest"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    list_maneuvers: {
        parameters: {
            query?: {
                /** @description `-` for falling order, then one of aircraft_name, airspeed_m_s, airspeed_ratio, axis, created_at, duration_s, dynamic_pressure_pa, flight_number, fta, fuel_fraction, id, label, max_input_correlation, n_runs. */
                sort?: string;
                /** @description Most items to answer. */
                limit?: number;
                /** @description `next` of the page before. */
                after?: string | null;
                aircraft_id?: number | null;
                flight_id?: number | null;
                /** @description Number of the flight-test aid. */
                fta?: number | null;
                /** @description Least V/V_f. */
                min_airspeed_ratio?: number | null;
                /** @description Largest V/V_f. */
                max_airspeed_ratio?: number | null;
                min_fuel?: number | null;
                max_fuel?: number | null;
                /** @description Part of label, note, file or aircraft. */
                search?: string | null;
                /** @description Only maneuvers with a run of this method. */
                method?: components["schemas"]["Method"] | null;
                /** @description State of the newest run, of `method` or of any. */
                state?: components["schemas"]["RunState"] | null;
                /** @description Mini-GVT records on the runway instead of flown maneuvers. */
                ground?: boolean;
                /** @description Only tagged so. */
                tag?: string | null;
                /** @description What was deleted instead. */
                deleted?: boolean;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ManeuverList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    upload_maneuver: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "multipart/form-data": components["schemas"]["Body_upload_maneuver"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ManeuverDetail"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    list_maneuver_facets: {
        parameters: {
            query?: {
                aircraft_id?: number | null;
                flight_id?: number | null;
                /** @description Number of the flight-test aid. */
                fta?: number | null;
                /** @description Least V/V_f. */
                min_airspeed_ratio?: number | null;
                /** @description Largest V/V_f. */
                max_airspeed_ratio?: number | null;
                min_fuel?: number | null;
                max_fuel?: number | null;
                /** @description Part of label, note, file or aircraft. */
                search?: string | null;
                /** @description Only maneuvers with a run of this method. */
                method?: components["schemas"]["Method"] | null;
                /** @description State of the newest run, of `method` or of any. */
                state?: components["schemas"]["RunState"] | null;
                /** @description Mini-GVT records on the runway instead of flown maneuvers. */
                ground?: boolean;
                /** @description Only tagged so. */
                tag?: string | null;
                /** @description What was deleted instead. */
                deleted?: boolean;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Facets"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    change_maneuvers: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["ChangeRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Changed"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_maneuver: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                maneuver_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ManeuverDetail"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    delete_maneuver: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                maneuver_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_run_proposal: {
        parameters: {
            query?: {
                low_hz?: number | null;
                high_hz?: number | null;
                /** @description Ids of maneuvers fitted together with it, by commas. */
                together_with?: string | null;
            };
            header?: never;
            path: {
                /** @description Id of the record. */
                maneuver_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["RunProposal"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_quality: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                maneuver_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ManeuverQuality"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    list_conditioning: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                maneuver_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ConditioningList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    take_conditioning: {
        parameters: {
            query?: never;
            header?: {
                /** @description Name of the analyst, percent-encoded UTF-8; nobody verifies it. */
                "X-Flexsid-Analyst"?: string;
            };
            path: {
                /** @description Id of the record. */
                maneuver_id: number;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["ConditioningRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ConditioningList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    undo_conditioning: {
        parameters: {
            query?: never;
            header?: {
                /** @description Name of the analyst, percent-encoded UTF-8; nobody verifies it. */
                "X-Flexsid-Analyst"?: string;
            };
            path: {
                /** @description Id of the record. */
                maneuver_id: number;
                /** @description Id of the record. */
                step_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ConditioningStep"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    list_qualities: {
        parameters: {
            query?: {
                aircraft_id?: number | null;
                flight_id?: number | null;
                /** @description `missing` for maneuvers nobody has looked at. */
                verdict?: ("good" | "doubtful" | "bad" | "unchecked" | "missing") | null;
                search?: string | null;
                /** @description `-` for falling order, then one of airspeed_drift, airspeed_ratio, flight_number, fuel_change, label, largest_skew_s, least_coherence, max_input_correlation, n_stretches, saturated, signal_to_noise_db, verdict. */
                sort?: string;
                /** @description Most items to answer. */
                limit?: number;
                /** @description `next` of the page before. */
                after?: string | null;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["QualityList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    assess_maneuvers: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["AssessRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            202: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Assessing"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    stop_assessing: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Assessing"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    list_mappings: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["MappingList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    add_mapping: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["MappingRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["StoredMapping"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_mapping: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                mapping_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["StoredMapping"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    delete_mapping: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                mapping_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    list_imports: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["UploadList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    upload_files: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "multipart/form-data": components["schemas"]["Body_upload_files"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["UploadDetail"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_upload: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the upload. */
                upload_id: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["UploadDetail"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    delete_upload: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the upload. */
                upload_id: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_upload_state: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the upload. */
                upload_id: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Upload"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    check_upload: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the upload. */
                upload_id: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["UploadMappingRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Checked"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    preview_upload: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the upload. */
                upload_id: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["PreviewRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    import_upload: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the upload. */
                upload_id: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["UploadMappingRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            202: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Upload"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    list_modal_tables: {
        parameters: {
            query?: {
                aircraft_id?: number | null;
                kind?: components["schemas"]["ModalKind"] | null;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ModalTableList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_model_order: {
        parameters: {
            query: {
                aircraft_id: number;
                airspeed_m_s: number;
                /** @description Fuel fraction. */
                fuel?: number;
                altitude_m?: number;
                modal_table_id?: number | null;
                prediction_id?: number | null;
                low_hz?: number;
                high_hz?: number;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ModelOrder"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_modal_table: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                modal_table_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ModalTableDetail"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    delete_modal_table: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                modal_table_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    list_modes: {
        parameters: {
            query?: {
                /** @description Fuel fraction. */
                fuel?: number;
            };
            header?: never;
            path: {
                /** @description Id of the record. */
                modal_table_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ModeList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_shape: {
        parameters: {
            query: {
                /** @description Number of the mode. */
                number: number;
                /** @description Fuel fraction. */
                fuel?: number;
                /** @description All nodes, not what can be seen. */
                every_node?: boolean;
            };
            header?: never;
            path: {
                /** @description Id of the record. */
                modal_table_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ShapeAnswer"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_correlation: {
        parameters: {
            query: {
                other_id: number;
                /** @description Fuel fraction. */
                fuel?: number;
                other_fuel?: number | null;
            };
            header?: never;
            path: {
                /** @description Id of the record. */
                modal_table_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Correlation"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_observability: {
        parameters: {
            query?: {
                /** @description Fuel fraction. */
                fuel?: number;
                symmetry?: "symmetric" | "antisymmetric" | "all";
                up_to_hz?: number;
            };
            header?: never;
            path: {
                /** @description Id of the record. */
                modal_table_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Observability"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    download_modes: {
        parameters: {
            query?: {
                form?: "uff" | "csv";
                /** @description Fuel fraction. */
                fuel?: number;
            };
            header?: never;
            path: {
                /** @description Id of the record. */
                modal_table_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    /**
                     * @example frequency_hz,bfs,wf1s
                     *     0.25,1.02,0.44
                     */
                    "text/csv": unknown;
                    /** @example static const float design_t[2400][5] = { */
                    "text/plain": unknown;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    correct_mode: {
        parameters: {
            query?: never;
            header?: {
                /** @description Name of the analyst, percent-encoded UTF-8; nobody verifies it. */
                "X-Flexsid-Analyst"?: string;
            };
            path: {
                /** @description Id of the record. */
                modal_table_id: number;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["CorrectionRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ModeCorrection"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    look_at_upload: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the upload. */
                upload_id: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["StructureFound"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    import_structure: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the upload. */
                upload_id: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["StructureFilesRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ModalTable"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    import_flutter_summary: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the upload. */
                upload_id: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["FlutterSummaryRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["FlutterSummary"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    list_flutter_summaries: {
        parameters: {
            query?: {
                aircraft_id?: number | null;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["FlutterSummaryList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_flutter_summary: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                summary_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["FlutterSummary"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    import_responses: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the upload. */
                upload_id: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["ResponsesRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["MeasuredResponses"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    list_measured_responses: {
        parameters: {
            query?: {
                aircraft_id?: number | null;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["MeasuredResponsesList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_measured_responses: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                responses_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["MeasuredResponses"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    find_modes: {
        parameters: {
            query?: {
                low_hz?: number | null;
                high_hz?: number | null;
                /** @description Highest order of the models. */
                order?: number;
            };
            header?: never;
            path: {
                /** @description Id of the record. */
                responses_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["FoundModes"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    keep_found_modes: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                responses_id: number;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["FoundModesRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ModalTable"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    check_orthogonality: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the upload. */
                upload_id: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["OrthogonalityRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Orthogonality"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    list_predictions: {
        parameters: {
            query?: {
                aircraft_id?: number | null;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["PredictionList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_prediction: {
        parameters: {
            query?: {
                /** @description Fuel fraction; by default the first. */
                fuel?: number | null;
            };
            header?: never;
            path: {
                /** @description Id of the record. */
                prediction_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["PredictionDetail"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    list_model_structures: {
        parameters: {
            query?: {
                aircraft_id?: number | null;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ModelStructureList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    add_model_structure: {
        parameters: {
            query?: never;
            header?: {
                /** @description Name of the analyst, percent-encoded UTF-8; nobody verifies it. */
                "X-Flexsid-Analyst"?: string;
            };
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["ModelStructureRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ModelStructure"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_model_structure: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                structure_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ModelStructure"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    edit_model_structure: {
        parameters: {
            query?: never;
            header?: {
                /** @description Version that was edited, e.g. `"3"`. */
                "if-match"?: string | null;
                /** @description Name of the analyst, percent-encoded UTF-8; nobody verifies it. */
                "X-Flexsid-Analyst"?: string;
            };
            path: {
                /** @description Id of the record. */
                structure_id: number;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["StructureEditRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ModelStructure"];
                };
            };
            /** @description Conflict */
            409: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["StaleStructure"] | components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    list_structure_versions: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                structure_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["StructureVersionList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_structure_version: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                structure_id: number;
                /** @description Version of the record. */
                version: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["StructureVersion"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    list_decisions: {
        parameters: {
            query?: {
                aircraft_id?: number | null;
                state?: components["schemas"]["DecisionState"] | null;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["DecisionList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    propose_decision: {
        parameters: {
            query?: never;
            header: {
                /** @description Name of the analyst, percent-encoded UTF-8; nobody verifies it. */
                "X-Flexsid-Analyst": string;
            };
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["ProposalRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["DecisionDetail"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_campaign_audit: {
        parameters: {
            query: {
                aircraft_id: number;
                /** @description For programs or for people. */
                format?: "json" | "markdown";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["AuditTrail"];
                    "text/markdown": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_decision: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                decision_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["DecisionDetail"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    revise_decision: {
        parameters: {
            query?: never;
            header: {
                /** @description Name of the analyst, percent-encoded UTF-8; nobody verifies it. */
                "X-Flexsid-Analyst": string;
            };
            path: {
                /** @description Id of the record. */
                decision_id: number;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["RevisionRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["DecisionDetail"];
                };
            };
            /** @description Conflict */
            409: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["StaleProposal"] | components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    comment_decision: {
        parameters: {
            query?: never;
            header: {
                /** @description Name of the analyst, percent-encoded UTF-8; nobody verifies it. */
                "X-Flexsid-Analyst": string;
            };
            path: {
                /** @description Id of the record. */
                decision_id: number;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["CommentRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["DecisionDetail"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    vote_on_decision: {
        parameters: {
            query?: never;
            header: {
                /** @description Name of the analyst, percent-encoded UTF-8; nobody verifies it. */
                "X-Flexsid-Analyst": string;
            };
            path: {
                /** @description Id of the record. */
                decision_id: number;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["VoteRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["DecisionDetail"];
                };
            };
            /** @description Conflict */
            409: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["StaleProposal"] | components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    withdraw_decision: {
        parameters: {
            query?: never;
            header: {
                /** @description Name of the analyst, percent-encoded UTF-8; nobody verifies it. */
                "X-Flexsid-Analyst": string;
            };
            path: {
                /** @description Id of the record. */
                decision_id: number;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["WithdrawalRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["DecisionDetail"];
                };
            };
            /** @description Conflict */
            409: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["StaleProposal"] | components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_decision_audit: {
        parameters: {
            query?: {
                /** @description For programs or for people. */
                format?: "json" | "markdown";
            };
            header?: never;
            path: {
                /** @description Id of the record. */
                decision_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["AuditTrail"];
                    "text/markdown": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_review_rules: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                aircraft_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["RulesHistory"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    change_review_rules: {
        parameters: {
            query?: never;
            header: {
                /** @description Name of the analyst, percent-encoded UTF-8; nobody verifies it. */
                "X-Flexsid-Analyst": string;
            };
            path: {
                /** @description Id of the record. */
                aircraft_id: number;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["RulesRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ReviewRules"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    list_campaign_baselines: {
        parameters: {
            query: {
                aircraft_id: number;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["BaselineList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    list_maneuver_baselines: {
        parameters: {
            query: {
                /** @description Ids of maneuvers, separated by commas. */
                maneuver_ids: string;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ManeuverBaselineList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    freeze_figure: {
        parameters: {
            query?: never;
            header: {
                /** @description Name of the analyst, percent-encoded UTF-8; nobody verifies it. */
                "X-Flexsid-Analyst": string;
            };
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["FreezeRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["FrozenFigure"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_frozen_figure: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                figure_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["FrozenFigure"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_notifications: {
        parameters: {
            query?: never;
            header: {
                /** @description Name of the analyst, percent-encoded UTF-8; nobody verifies it. */
                "X-Flexsid-Analyst": string;
            };
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Notifications"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    mark_notifications_seen: {
        parameters: {
            query?: never;
            header: {
                /** @description Name of the analyst, percent-encoded UTF-8; nobody verifies it. */
                "X-Flexsid-Analyst": string;
            };
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    mark_decision_seen: {
        parameters: {
            query?: never;
            header: {
                /** @description Name of the analyst, percent-encoded UTF-8; nobody verifies it. */
                "X-Flexsid-Analyst": string;
            };
            path: {
                /** @description Id of the record. */
                decision_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    mark_structure_seen: {
        parameters: {
            query?: never;
            header: {
                /** @description Name of the analyst, percent-encoded UTF-8; nobody verifies it. */
                "X-Flexsid-Analyst": string;
            };
            path: {
                /** @description Id of the record. */
                structure_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    list_runs: {
        parameters: {
            query?: {
                /** @description `-` for falling order, then one of airspeed_ratio, author, created_at, dynamic_pressure_pa, finished_at, flight_number, fta, fuel_fraction, id, maneuver_label, method, state. */
                sort?: string;
                /** @description Most items to answer. */
                limit?: number;
                /** @description `next` of the page before. */
                after?: string | null;
                aircraft_id?: number | null;
                flight_id?: number | null;
                maneuver_id?: number | null;
                structure_id?: number | null;
                fta?: number | null;
                min_airspeed_ratio?: number | null;
                max_airspeed_ratio?: number | null;
                min_fuel?: number | null;
                max_fuel?: number | null;
                method?: components["schemas"]["Method"] | null;
                state?: components["schemas"]["RunState"] | null;
                /** @description Only tagged so. */
                tag?: string | null;
                /** @description Part of maneuver or author, or an id. */
                search?: string | null;
                /** @description What was deleted instead. */
                deleted?: boolean;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["RunList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    request_run: {
        parameters: {
            query?: never;
            header?: {
                /** @description Name of the analyst, percent-encoded UTF-8; nobody verifies it. */
                "X-Flexsid-Analyst"?: string;
            };
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["RunRequest"];
            };
        };
        responses: {
            /** @description The same run had been asked for before */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Run"];
                };
            };
            /** @description Successful Response */
            202: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Run"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    list_run_facets: {
        parameters: {
            query?: {
                aircraft_id?: number | null;
                flight_id?: number | null;
                maneuver_id?: number | null;
                structure_id?: number | null;
                fta?: number | null;
                min_airspeed_ratio?: number | null;
                max_airspeed_ratio?: number | null;
                min_fuel?: number | null;
                max_fuel?: number | null;
                method?: components["schemas"]["Method"] | null;
                state?: components["schemas"]["RunState"] | null;
                /** @description Only tagged so. */
                tag?: string | null;
                /** @description Part of maneuver or author, or an id. */
                search?: string | null;
                /** @description What was deleted instead. */
                deleted?: boolean;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Facets"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    change_runs: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["ChangeRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Changed"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_run: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                run_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Run"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    delete_run: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                run_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_run_export: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                run_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["RunExport"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_run_model: {
        parameters: {
            query?: {
                /** @description `mat` for MATLAB. */
                format?: "json" | "mat";
            };
            header?: never;
            path: {
                /** @description Id of the record. */
                run_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ModelExport"];
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    list_saved_views: {
        parameters: {
            query?: {
                page?: string | null;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["SavedViewList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    add_saved_view: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["SavedViewRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["SavedView"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    delete_saved_view: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                view_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    list_searches: {
        parameters: {
            query?: {
                aircraft_id?: number | null;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["SearchList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    request_search: {
        parameters: {
            query?: never;
            header?: {
                /** @description Name of the analyst, percent-encoded UTF-8; nobody verifies it. */
                "X-Flexsid-Analyst"?: string;
            };
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["SearchRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            202: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["StructureSearch"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_search: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                search_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["StructureSearch"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    cancel_search: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                search_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["StructureSearch"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    open_candidate: {
        parameters: {
            query?: never;
            header?: {
                /** @description Name of the analyst, percent-encoded UTF-8; nobody verifies it. */
                "X-Flexsid-Analyst"?: string;
            };
            path: {
                /** @description Id of the record. */
                search_id: number;
                /** @description Place among the candidates, from 0. */
                place: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Run"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    list_jobs: {
        parameters: {
            query?: {
                state?: components["schemas"]["RunState"] | null;
                batch_id?: number | null;
                /** @description Only these, separated by commas. */
                ids?: string | null;
                /** @description Most items to answer. */
                limit?: number;
                /** @description `next` of the page before. */
                after?: string | null;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["JobList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_queue_status: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["QueueStatus"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_job: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                job_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Job"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_job_log: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                job_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["JobLog"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    cancel_job: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                job_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            202: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Job"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    retry_job: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                job_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            202: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Job"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    stream_events: {
        parameters: {
            query?: {
                /** @description Last event known. */
                after?: number | null;
            };
            header?: {
                "last-event-id"?: string | null;
            };
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    /**
                     * @example id: 12
                     *     event: run
                     *     data: {"run_id": 1, "state": "succeeded"}
                     */
                    "text/event-stream": unknown;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "text/event-stream": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    list_batches: {
        parameters: {
            query?: {
                /** @description Most items to answer. */
                limit?: number;
                /** @description `next` of the page before. */
                after?: string | null;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["BatchList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    request_batch: {
        parameters: {
            query?: never;
            header?: {
                /** @description Name of the analyst, percent-encoded UTF-8; nobody verifies it. */
                "X-Flexsid-Analyst"?: string;
            };
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["BatchRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            202: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["QueuedBatch"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_batch: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                batch_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["BatchProgress"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    cancel_batch: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                batch_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            202: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["BatchProgress"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    retry_batch: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                batch_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            202: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["BatchProgress"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_comparison: {
        parameters: {
            query: {
                /** @description Ids of runs, separated by commas. */
                run_ids: string;
                /** @description Ids of predictions, separated by commas. */
                prediction_ids?: string | null;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Comparison"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_trend: {
        parameters: {
            query: {
                /** @description Ids of runs, separated by commas. */
                run_ids: string;
                /** @description Derivative, e.g. Cm_alpha. */
                name: string;
                against?: components["schemas"]["Against"];
                /** @description Ids of predictions, separated by commas. */
                prediction_ids?: string | null;
                /** @description Of the weighted polynomial. */
                degree?: number;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["DerivativeTrend"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    report_run: {
        parameters: {
            query?: {
                /** @description `pdf` where the server has Chromium. */
                format?: "html" | "pdf";
            };
            header?: never;
            path: {
                /** @description Id of the record. */
                run_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "text/html": string;
                    "application/pdf": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    report_comparison: {
        parameters: {
            query: {
                /** @description Ids of runs, separated by commas. */
                run_ids: string;
                /** @description Ids of predictions, separated by commas. */
                prediction_ids?: string | null;
                /** @description `pdf` where the server has Chromium. */
                format?: "html" | "pdf";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "text/html": string;
                    "application/pdf": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    report_decision: {
        parameters: {
            query?: {
                /** @description `pdf` where the server has Chromium. */
                format?: "html" | "pdf";
            };
            header?: never;
            path: {
                /** @description Id of the record. */
                decision_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "text/html": string;
                    "application/pdf": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    report_campaign: {
        parameters: {
            query?: {
                /** @description `pdf` where the server has Chromium. */
                format?: "html" | "pdf";
                aircraft_id?: number | null;
                flight_id?: number | null;
                /** @description Number of the flight-test aid. */
                fta?: number | null;
                /** @description Least V/V_f. */
                min_airspeed_ratio?: number | null;
                /** @description Largest V/V_f. */
                max_airspeed_ratio?: number | null;
                min_fuel?: number | null;
                max_fuel?: number | null;
                /** @description Part of label, note, file or aircraft. */
                search?: string | null;
                /** @description Only maneuvers with a run of this method. */
                method?: components["schemas"]["Method"] | null;
                /** @description State of the newest run, of `method` or of any. */
                state?: components["schemas"]["RunState"] | null;
                /** @description Mini-GVT records on the runway instead of flown maneuvers. */
                ground?: boolean;
                /** @description Only tagged so. */
                tag?: string | null;
                /** @description What was deleted instead. */
                deleted?: boolean;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "text/html": string;
                    "application/pdf": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    list_designs: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["DesignList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    create_design: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["DesignRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ExcitationDesign"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    search_design: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["DesignRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            202: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Task"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    import_flown: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "multipart/form-data": components["schemas"]["Body_import_flown"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["DesignList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    list_catalogue: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["CatalogueList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_design: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                design_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ExcitationDesign"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    delete_design: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                design_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    check_design: {
        parameters: {
            query: {
                /** @description Actuator's. [rad/s] */
                natural_frequency: number;
                damping?: number;
                delay_s?: number;
                /** @description [rad], at most 1.05 (60 deg). */
                position?: number | null;
                /** @description [rad/s], at most 50 (2900 deg/s). */
                rate?: number | null;
                acceleration?: number | null;
                /** @description Amplitude: 0 low, 1 medium, 2 high. */
                level?: number;
            };
            header?: never;
            path: {
                /** @description Id of the record. */
                design_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["DesignChecks"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_target_modes: {
        parameters: {
            query: {
                aircraft_id: number;
            };
            header?: never;
            path: {
                /** @description Id of the record. */
                design_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["TargetModes"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    expect_errors: {
        parameters: {
            query: {
                run_id: number;
                /** @description Amplitude: 0 low, 1 medium, 2 high. */
                level?: number;
            };
            header?: never;
            path: {
                /** @description Id of the record. */
                design_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ExpectedErrors"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    expect_response: {
        parameters: {
            query: {
                run_id: number;
                /** @description Amplitude: 0 low, 1 medium, 2 high. */
                level?: number;
            };
            header?: never;
            path: {
                /** @description Id of the record. */
                design_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ExpectedSummary"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    compare_classic_inputs: {
        parameters: {
            query: {
                run_id: number;
                /** @description Amplitude: 0 low, 1 medium, 2 high. */
                level?: number;
            };
            header?: never;
            path: {
                /** @description Id of the record. */
                design_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["InputComparison"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    allocate_amplitudes: {
        parameters: {
            query: {
                run_id: number;
                /** @description [rad], at most 1.05 (60 deg). */
                deflection?: number | null;
                load_factor?: number | null;
                /** @description Amplitude: 0 low, 1 medium, 2 high. */
                level?: number;
            };
            header?: never;
            path: {
                /** @description Id of the record. */
                design_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Allocation"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    rescale_design: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                design_id: number;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["RescaleRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ExcitationDesign"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    redesign: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                design_id: number;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["RedesignRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            202: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Task"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    list_rehearsals: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                design_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["RehearsalList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    rehearse: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                design_id: number;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["RehearsalRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            202: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Task"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    export_design: {
        parameters: {
            query?: {
                form?: "csv" | "mat" | "h" | "json";
                /** @description Amplitude: 0 low, 1 medium, 2 high. */
                level?: number;
            };
            header?: never;
            path: {
                /** @description Id of the record. */
                design_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "text/csv": string;
                    "application/octet-stream": string;
                    "text/plain": string;
                    "application/json": Record<string, never>;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    list_controllers: {
        parameters: {
            query?: {
                aircraft_id?: number | null;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ControllerList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    create_controller: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["ControllerRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Controller"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    upload_controller: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "multipart/form-data": components["schemas"]["Body_upload_controller"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Controller"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_controller: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                controller_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Controller"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    delete_controller: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                controller_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    find_flutter: {
        parameters: {
            query: {
                /** @description Runs that succeeded, separated by commas. */
                run_ids: string;
                /** @description Fuel fraction; the fastest point's. */
                fuel?: number | null;
                /** @description Standard altitude; the fastest point's air. */
                altitude_m?: number | null;
                /** @description Airspeed of the next point; 3 % above the fastest. */
                next_m_s?: number | null;
                /** @description Modes the runs left out: as predicted, or their static response. */
                others?: components["schemas"]["Others"];
                /** @description Derivatives drift linearly with dynamic pressure. */
                trend?: boolean;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            202: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Task"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_flutter: {
        parameters: {
            query: {
                /** @description Runs that succeeded, separated by commas. */
                run_ids: string;
                /** @description Fuel fraction; the fastest point's. */
                fuel?: number | null;
                /** @description Standard altitude; the fastest point's air. */
                altitude_m?: number | null;
                /** @description Airspeed of the next point; 3 % above the fastest. */
                next_m_s?: number | null;
                /** @description Modes the runs left out: as predicted, or their static response. */
                others?: components["schemas"]["Others"];
                /** @description Derivatives drift linearly with dynamic pressure. */
                trend?: boolean;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Flutter"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    find_closed_loop: {
        parameters: {
            query: {
                controller_id: number;
                /** @description Runs that succeeded, separated by commas. */
                run_ids: string;
                /** @description Fuel fraction; the fastest point's. */
                fuel?: number | null;
                /** @description Standard altitude; the fastest point's air. */
                altitude_m?: number | null;
                /** @description Airspeed of the next point; 3 % above the fastest. */
                next_m_s?: number | null;
                /** @description Modes the runs left out: as predicted, or their static response. */
                others?: components["schemas"]["Others"];
                /** @description Derivatives drift linearly with dynamic pressure. */
                trend?: boolean;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            202: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Task"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_closed_loop: {
        parameters: {
            query: {
                controller_id: number;
                /** @description Runs that succeeded, separated by commas. */
                run_ids: string;
                /** @description Fuel fraction; the fastest point's. */
                fuel?: number | null;
                /** @description Standard altitude; the fastest point's air. */
                altitude_m?: number | null;
                /** @description Airspeed of the next point; 3 % above the fastest. */
                next_m_s?: number | null;
                /** @description Modes the runs left out: as predicted, or their static response. */
                others?: components["schemas"]["Others"];
                /** @description Derivatives drift linearly with dynamic pressure. */
                trend?: boolean;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ClosedLoopAnswer"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    list_tasks: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["TaskList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    get_task: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                task_id: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Task"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    cancel_task: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                task_id: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Task"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    draw_envelope: {
        parameters: {
            query?: {
                /** @description Figure, or the numbers it shows. */
                format?: "json" | "csv" | "mat";
                aircraft_id?: number | null;
                flight_id?: number | null;
                /** @description Number of the flight-test aid. */
                fta?: number | null;
                /** @description Least V/V_f. */
                min_airspeed_ratio?: number | null;
                /** @description Largest V/V_f. */
                max_airspeed_ratio?: number | null;
                min_fuel?: number | null;
                max_fuel?: number | null;
                /** @description Part of label, note, file or aircraft. */
                search?: string | null;
                /** @description Only maneuvers with a run of this method. */
                method?: components["schemas"]["Method"] | null;
                /** @description State of the newest run, of `method` or of any. */
                state?: components["schemas"]["RunState"] | null;
                /** @description Mini-GVT records on the runway instead of flown maneuvers. */
                ground?: boolean;
                /** @description Only tagged so. */
                tag?: string | null;
                /** @description What was deleted instead. */
                deleted?: boolean;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    draw_time_history: {
        parameters: {
            query: {
                maneuver_id: number;
                /** @description Names separated by commas. */
                channels?: string | null;
                start_s?: number | null;
                stop_s?: number | null;
                points?: number;
                /** @description Figure, or the numbers it shows. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    draw_flight_history: {
        parameters: {
            query: {
                flight_id: number;
                /** @description Names separated by commas. */
                channels?: string | null;
                start_s?: number | null;
                stop_s?: number | null;
                points?: number;
                /** @description Figure, or the numbers it shows. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    draw_spectrum: {
        parameters: {
            query: {
                maneuver_id: number;
                /** @description Names separated by commas. */
                channels?: string | null;
                /** @description The whole spectrum behind the lines. */
                full?: boolean;
                /** @description Figure, or the numbers it shows. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    draw_signal_to_noise: {
        parameters: {
            query: {
                maneuver_id: number;
                /** @description Names separated by commas. */
                channels?: string | null;
                /** @description Figure, or the numbers it shows. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    draw_plot_matrix: {
        parameters: {
            query: {
                maneuver_id: number;
                /** @description Names separated by commas. */
                channels?: string | null;
                domain?: "time" | "frequency";
                /** @description Regressors of equation error with these modes instead. */
                modes?: string | null;
                /** @description Figure, or the numbers it shows. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    draw_bode: {
        parameters: {
            query: {
                maneuver_id: number;
                /** @description Outputs separated by commas. */
                output: string;
                /** @description Names separated by commas. */
                inputs?: string | null;
                /** @description Ids separated by commas. */
                run_id?: string | null;
                /** @description Ids of further maneuvers, laid over this one. */
                beside?: string | null;
                /** @description All maneuvers as one response. */
                average?: boolean;
                /** @description Models also with sensors blind to modes. */
                rigid?: boolean;
                /** @description From averaged windows, as where no lines are known. */
                windowed?: boolean;
                view?: "bode" | "nichols" | "nyquist";
                /** @description Figure, or the numbers it shows. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    draw_reconstruction: {
        parameters: {
            query: {
                maneuver_id: number;
                /** @description alpha, q, CZ, Cm, CQ7, eta7, etaddot7 ... by commas. */
                quantities?: string | null;
                /** @description Mode numbers; by default as many as move. */
                modes?: string | null;
                domain?: "time" | "frequency";
                /** @description Figure, or the numbers it shows. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    draw_loops: {
        parameters: {
            query: {
                maneuver_id: number;
                /** @description Figure, or the numbers it shows. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    draw_ground_test: {
        parameters: {
            query: {
                flight_id: number;
                /** @description Figure, or the numbers it shows. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    draw_fit: {
        parameters: {
            query: {
                run_id: number;
                /** @description Names separated by commas. */
                output?: string | null;
                /** @description Block of lines; the run's first by default. */
                block?: string | null;
                /** @description Figure, or the numbers it shows. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    draw_residual: {
        parameters: {
            query: {
                run_id: number;
                /** @description Block of lines; the run's first by default. */
                block?: string | null;
                /** @description Figure, or the numbers it shows. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    draw_parameter_correlation: {
        parameters: {
            query: {
                run_id: number;
                /** @description Figure, or the numbers it shows. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    draw_poles: {
        parameters: {
            query: {
                /** @description Ids of runs, separated by commas. */
                run_id: string;
                /** @description Figure, or the numbers it shows. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    draw_iterations: {
        parameters: {
            query: {
                run_id: number;
                /** @description Figure, or the numbers it shows. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    draw_time_check: {
        parameters: {
            query: {
                run_id: number;
                /** @description Names separated by commas. */
                outputs?: string | null;
                maneuver_id?: number | null;
                points?: number;
                /** @description Figure, or the numbers it shows. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    draw_derivatives: {
        parameters: {
            query: {
                /** @description Ids separated by commas. */
                run_ids: string;
                /** @description Ids separated by commas. */
                prediction_ids?: string | null;
                /** @description CZ, Cm, CQ7 ... */
                coefficient?: string | null;
                /** @description Figure, or the numbers it shows. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    draw_forest: {
        parameters: {
            query: {
                /** @description Ids separated by commas. */
                run_ids: string;
                /** @description Derivative, e.g. Cm_alpha. */
                name: string;
                /** @description Ids separated by commas. */
                prediction_ids?: string | null;
                /** @description Figure, or the numbers it shows. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    draw_trend: {
        parameters: {
            query: {
                /** @description Figure, or the numbers it shows. */
                format?: "json" | "csv" | "mat";
                /** @description Ids of runs, separated by commas. */
                run_ids: string;
                /** @description Derivative, e.g. Cm_alpha. */
                name: string;
                against?: components["schemas"]["Against"];
                /** @description Ids of predictions, separated by commas. */
                prediction_ids?: string | null;
                /** @description Of the weighted polynomial. */
                degree?: number;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    draw_v_omega_zeta: {
        parameters: {
            query: {
                /** @description What roots are followed along. */
                along?: components["schemas"]["Along"];
                /** @description Figure, or the numbers it shows. */
                format?: "json" | "csv" | "mat";
                /** @description Runs that succeeded, separated by commas. */
                run_ids: string;
                /** @description Fuel fraction; the fastest point's. */
                fuel?: number | null;
                /** @description Standard altitude; the fastest point's air. */
                altitude_m?: number | null;
                /** @description Airspeed of the next point; 3 % above the fastest. */
                next_m_s?: number | null;
                /** @description Modes the runs left out: as predicted, or their static response. */
                others?: components["schemas"]["Others"];
                /** @description Derivatives drift linearly with dynamic pressure. */
                trend?: boolean;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    draw_root_locus: {
        parameters: {
            query: {
                /** @description What roots are followed along. */
                along?: components["schemas"]["Along"];
                /** @description Figure, or the numbers it shows. */
                format?: "json" | "csv" | "mat";
                /** @description Runs that succeeded, separated by commas. */
                run_ids: string;
                /** @description Fuel fraction; the fastest point's. */
                fuel?: number | null;
                /** @description Standard altitude; the fastest point's air. */
                altitude_m?: number | null;
                /** @description Airspeed of the next point; 3 % above the fastest. */
                next_m_s?: number | null;
                /** @description Modes the runs left out: as predicted, or their static response. */
                others?: components["schemas"]["Others"];
                /** @description Derivatives drift linearly with dynamic pressure. */
                trend?: boolean;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    draw_equivalent_modes: {
        parameters: {
            query: {
                /** @description Figure, or the numbers it shows. */
                format?: "json" | "csv" | "mat";
                /** @description Runs that succeeded, separated by commas. */
                run_ids: string;
                /** @description Fuel fraction; the fastest point's. */
                fuel?: number | null;
                /** @description Standard altitude; the fastest point's air. */
                altitude_m?: number | null;
                /** @description Airspeed of the next point; 3 % above the fastest. */
                next_m_s?: number | null;
                /** @description Modes the runs left out: as predicted, or their static response. */
                others?: components["schemas"]["Others"];
                /** @description Derivatives drift linearly with dynamic pressure. */
                trend?: boolean;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    draw_flutter_forecast: {
        parameters: {
            query: {
                /** @description Figure, or the numbers it shows. */
                format?: "json" | "csv" | "mat";
                /** @description Runs that succeeded, separated by commas. */
                run_ids: string;
                /** @description Fuel fraction; the fastest point's. */
                fuel?: number | null;
                /** @description Standard altitude; the fastest point's air. */
                altitude_m?: number | null;
                /** @description Airspeed of the next point; 3 % above the fastest. */
                next_m_s?: number | null;
                /** @description Modes the runs left out: as predicted, or their static response. */
                others?: components["schemas"]["Others"];
                /** @description Derivatives drift linearly with dynamic pressure. */
                trend?: boolean;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    draw_flutter_map: {
        parameters: {
            query: {
                /** @description Figure, or the numbers it shows. */
                format?: "json" | "csv" | "mat";
                /** @description Runs that succeeded, separated by commas. */
                run_ids: string;
                /** @description Fuel fraction; the fastest point's. */
                fuel?: number | null;
                /** @description Standard altitude; the fastest point's air. */
                altitude_m?: number | null;
                /** @description Airspeed of the next point; 3 % above the fastest. */
                next_m_s?: number | null;
                /** @description Modes the runs left out: as predicted, or their static response. */
                others?: components["schemas"]["Others"];
                /** @description Derivatives drift linearly with dynamic pressure. */
                trend?: boolean;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    draw_closed_loop_margins: {
        parameters: {
            query: {
                controller_id: number;
                /** @description Figure, or the numbers it shows. */
                format?: "json" | "csv" | "mat";
                /** @description Runs that succeeded, separated by commas. */
                run_ids: string;
                /** @description Fuel fraction; the fastest point's. */
                fuel?: number | null;
                /** @description Standard altitude; the fastest point's air. */
                altitude_m?: number | null;
                /** @description Airspeed of the next point; 3 % above the fastest. */
                next_m_s?: number | null;
                /** @description Modes the runs left out: as predicted, or their static response. */
                others?: components["schemas"]["Others"];
                /** @description Derivatives drift linearly with dynamic pressure. */
                trend?: boolean;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    draw_closed_loop_roots: {
        parameters: {
            query: {
                controller_id: number;
                /** @description Figure, or the numbers it shows. */
                format?: "json" | "csv" | "mat";
                /** @description Runs that succeeded, separated by commas. */
                run_ids: string;
                /** @description Fuel fraction; the fastest point's. */
                fuel?: number | null;
                /** @description Standard altitude; the fastest point's air. */
                altitude_m?: number | null;
                /** @description Airspeed of the next point; 3 % above the fastest. */
                next_m_s?: number | null;
                /** @description Modes the runs left out: as predicted, or their static response. */
                others?: components["schemas"]["Others"];
                /** @description Derivatives drift linearly with dynamic pressure. */
                trend?: boolean;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    draw_search_path: {
        parameters: {
            query: {
                search_id: number;
                /** @description Coefficient (EE) or method; the first. */
                group?: string | null;
                /** @description Figure, or the numbers it shows. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    draw_search_stability: {
        parameters: {
            query: {
                search_id: number;
                /** @description Coefficient (EE) or method; the first. */
                group?: string | null;
                /** @description Figure, or the numbers it shows. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    draw_design_history: {
        parameters: {
            query: {
                design_id: number;
                /** @description Amplitude: 0 low, 1 medium, 2 high. */
                level?: number;
                /** @description Figure, or the numbers it shows. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    draw_design_spectrum: {
        parameters: {
            query: {
                design_id: number;
                /** @description Amplitude: 0 low, 1 medium, 2 high. */
                level?: number;
                /** @description Figure, or the numbers it shows. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    draw_design_worth: {
        parameters: {
            query: {
                design_id: number;
                run_id: number;
                /** @description Amplitude: 0 low, 1 medium, 2 high. */
                level?: number;
                /** @description Figure, or the numbers it shows. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    draw_design_signal: {
        parameters: {
            query: {
                design_id: number;
                run_id: number;
                /** @description Amplitude: 0 low, 1 medium, 2 high. */
                level?: number;
                /** @description Figure, or the numbers it shows. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    draw_frozen: {
        parameters: {
            query: {
                figure_id: number;
                /** @description Figure, or the numbers it shows. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    draw_modes_against_fuel: {
        parameters: {
            query: {
                modal_table_id: number;
                /** @description Figure, or the numbers it shows. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    draw_assurance: {
        parameters: {
            query: {
                modal_table_id: number;
                /** @description Fuel fraction. */
                fuel?: number;
                other_id?: number | null;
                other_fuel?: number | null;
                /** @description Figure, or the numbers it shows. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    draw_model_order: {
        parameters: {
            query: {
                /** @description Derivatives to draw, separated by commas. */
                derivatives?: string;
                /** @description Figure, or the numbers it shows. */
                format?: "json" | "csv" | "mat";
                aircraft_id: number;
                airspeed_m_s: number;
                /** @description Fuel fraction. */
                fuel?: number;
                altitude_m?: number;
                modal_table_id?: number | null;
                prediction_id?: number | null;
                low_hz?: number;
                high_hz?: number;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    draw_reduced_responses: {
        parameters: {
            query: {
                output: string;
                surface: string;
                /** @description Modes kept, separated by commas. */
                counts?: string;
                /** @description Figure, or the numbers it shows. */
                format?: "json" | "csv" | "mat";
                aircraft_id: number;
                airspeed_m_s: number;
                /** @description Fuel fraction. */
                fuel?: number;
                altitude_m?: number;
                modal_table_id?: number | null;
                prediction_id?: number | null;
                low_hz?: number;
                high_hz?: number;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    draw_stabilisation: {
        parameters: {
            query: {
                responses_id: number;
                /** @description Figure, or the numbers it shows. */
                format?: "json" | "csv" | "mat";
                low_hz?: number | null;
                high_hz?: number | null;
                /** @description Highest order of the models. */
                order?: number;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
    list_nomenclature: {
        parameters: {
            query?: {
                /** @description Channels, derivatives or symbols, separated by commas; else the glossary. */
                names?: string | null;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Glossary"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["flexsid__api__errors__Problem"];
                };
            };
        };
    };
}
