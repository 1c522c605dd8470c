{{%AUTOESCAPE context="HTML"}}
{{>HEAD}}
<body>
<main>
<nav class="crumbs" aria-label="Where you are"><a href="../../">Fleet</a> / <span>{{ROBOT}}</span></nav>
<div id="live" data-fresh data-live="../../api/v1/live?robot={{ROBOT}}">
<header>
<h1>{{ROBOT}}</h1>
<p class="meta">{{SUMMARY}}{{#MODEL}}, rig model <a href="../../models/{{PATH}}/"><bdi>{{NAME}}</bdi></a>{{/MODEL}}{{#SITE}}, at <bdi>{{NAME}}</bdi>{{/SITE}}</p>
</header>
{{>BANNER}}
{{>FIGURES}}
{{#NEWER}}<p class="working" role="status">{{TEXT:x-typed}} This page still tells revision {{NUMBER}}.</p>{{/NEWER}}
{{#APPROVAL}}<p class="working" dir="auto">{{TEXT:x-typed}}</p>{{/APPROVAL}}
{{#RUNS}}<p class="working" dir="auto">{{TEXT}}</p>{{/RUNS}}
{{#NEWEST}}<p class="ways"><a class="button" href="revisions/{{NUMBER}}/">Report of revision {{NUMBER}}</a> <a class="button" href="revisions/{{NUMBER}}/certificate.html">{{SHEET}} to print</a>{{#SINCE}} <a class="button" href="compare?a={{BEFORE}}&amp;b={{NUMBER}}">What moved since revision {{BEFORE}}</a>{{/SINCE}}</p>{{/NEWEST}}
{{#OPEN}}
<p class="working"><a href="sessions/{{ID}}/">Session {{SHORT}}</a> {{STATE}}: {{DONE}} of {{ALL}} {{UNIT}} <progress value="{{DONE}}" max="{{ALL}}" aria-label="Progress of session {{SHORT}}"></progress></p>
{{/OPEN}}
{{#MORE_OPEN}}<p class="hint">{{COUNT}} did not come whole, or are not calibrated yet, either.</p>{{/MORE_OPEN}}
{{#REVISIONS}}
<section class="card">
<h2 id="revisions">Revisions <span class="soft">newest first</span></h2>
<div class="scroll" tabindex="0" role="region" aria-labelledby="revisions">
<table class="list">
<thead><tr><th scope="col">Revision</th><th scope="col">Verdict</th><th scope="col">Solved</th><th scope="col">What changed</th></tr></thead>
<tbody>
{{#REVISION}}
<tr><th scope="row"><a href="revisions/{{NUMBER}}/">revision {{NUMBER}}</a></th><td class="text"><span class="badge {{LEVEL}}">{{WORD}}</span>{{#STATE}} <span class="badge unknown">{{WORD}}</span>{{/STATE}} <span class="why" dir="auto">{{WHY}}</span></td><td class="text" data-label="Solved">{{TIME}} <br><span class="soft">{{AGE}}</span></td><td class="text whole">{{#CHANGED}}<a href="compare?a={{BEFORE}}&amp;b={{NUMBER}}">against revision {{BEFORE}}</a>{{/CHANGED}}{{#FIRST}}<span class="soft">the first</span>{{/FIRST}}</td></tr>
{{/REVISION}}
</tbody>
</table>
</div>
{{#PAGES}}<p class="hint">{{#NEWEST_PAGE}}<a href="./#revisions">The newest revisions</a> {{/NEWEST_PAGE}}{{#OLDER}}<a href="?before={{BEFORE}}#revisions">Older revisions</a>{{/OLDER}}</p>{{/PAGES}}
</section>
{{/REVISIONS}}
{{#SESSIONS}}
<section class="card">
<h2 id="sessions">Sessions <span class="soft">newest first</span></h2>
<div class="scroll" tabindex="0" role="region" aria-labelledby="sessions">
<table class="list">
<thead><tr><th scope="col">Session</th><th scope="col">Captured</th><th scope="col">Operator</th><th scope="col">Result</th><th scope="col" class="num">Files</th></tr></thead>
<tbody>
{{#SESSION}}
<tr><th scope="row"><a href="sessions/{{ID}}/"><code>{{SHORT}}</code></a></th><td class="text" data-label="Captured">{{TIME}} <span class="soft">{{AGE}}</span></td><td class="text" data-label="Operator" dir="auto">{{OPERATOR}}</td><td class="text" data-label="Result">{{GOOD}}{{#PAST}} <span class="badge unknown">{{COUNT}} past</span>{{/PAST}}{{#FAILED}} <span class="badge fail">{{COUNT}} failed</span>{{/FAILED}}{{#WORKING}}<span class="soft">{{WORD}}</span>{{/WORKING}}{{#RETIRED}}<span class="badge unknown">retired</span> <span class="why" dir="auto">{{WHY}}.</span> <span class="cure">To bring it back: <code class="typed">{{COMMAND}}</code></span>{{/RETIRED}}{{#SUPERSEDED}}<span class="badge unknown">superseded</span> <span class="why" dir="auto">by <a href="sessions/{{BY}}/"><code>{{SHORT}}</code></a> (captured {{TIME}}{{#PEOPLE}}, by <bdi>{{NAME}}</bdi>{{/PEOPLE}}), {{HOW}} on {{SINCE}}.</span> <span class="cure">If it should not be: <code class="typed">rigcal restore {{OLD}}</code></span>{{/SUPERSEDED}}</td><td data-label="Files">{{FILES}}</td></tr>
{{/SESSION}}
</tbody>
</table>
</div>
{{#PAGES}}<p class="hint">{{#NEWEST_PAGE}}<a href="./#sessions">The newest sessions</a> {{/NEWEST_PAGE}}{{#OLDER}}<a href="?sessions_before={{BEFORE}}#sessions">Older sessions</a>{{/OLDER}}</p>{{/PAGES}}
</section>
{{/SESSIONS}}
{{#EPOCHS}}
<section class="card">
<h2 id="epochs">Epochs <span class="soft">what was measured of a sensor before is past; newest first</span></h2>
<ul>
{{#EPOCH}}<li dir="auto">{{TIME}}: {{TEXT}}{{#SESSION}} <a href="sessions/{{ID}}/"><code>{{SHORT}}</code></a>{{/SESSION}}</li>
{{/EPOCH}}
</ul>
{{#MORE}}<p class="hint">{{TEXT}}</p>{{/MORE}}
</section>
{{/EPOCHS}}
{{#GONE_SENSORS}}
<section class="card">
<h2 id="gone">Retired sensors <span class="soft">what was measured of them is past</span></h2>
{{#GONE}}<p dir="auto"><span class="badge unknown">past</span> {{WHY}}. To bring it back: <code class="typed">{{COMMAND}}</code></p>
{{/GONE}}
</section>
{{/GONE_SENSORS}}
</div>
<div id="compare" data-fresh>
{{#COMPARE}}
<form class="search card" action="compare" method="get">
<h2>Compare</h2>
<label>Revision <select name="a">{{#CHOICE_A}}<option{{#CHOSEN}} selected{{/CHOSEN}}>{{NUMBER}}</option>{{/CHOICE_A}}</select></label>
<label>with <select name="b">{{#CHOICE_B}}<option{{#CHOSEN}} selected{{/CHOSEN}}>{{NUMBER}}</option>{{/CHOICE_B}}</select></label>
<button>Compare</button>
</form>
{{/COMPARE}}
</div>
{{#TRENDS}}
<section class="card" id="history" aria-labelledby="trends">
<h2 id="trends">History of each sensor <span class="soft">the farthest step first</span></h2>
<noscript><p class="hint">The charts need a script. Compare two revisions to read how far each sensor moved.</p></noscript>
{{#TREND}}<div class="plots trend" data-trend="{{SENSOR}}"></div>
{{/TREND}}
</section>
{{/TRENDS}}
</main>
{{#SCRIPT}}<script defer src="{{PATH}}"></script>
{{/SCRIPT}}
{{#LATER}}<script defer src="{{PATH}}" data-scripts="{{SCRIPTS}}"></script>
{{/LATER}}
</body>
</html>
