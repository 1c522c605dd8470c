{{%AUTOESCAPE context="HTML"}}
<section class="banner {{LEVEL}}{{#OVERDUE}} overdue{{/OVERDUE}}" aria-label="Verdict">
<svg class="icon" viewBox="0 0 24 24" aria-hidden="true"><path class="verdict" d="{{ICON}}"/><path class="late" d="M12 3.5L22 20.5H2ZM12 10v4.5M12 17.4v.1"/></svg>
<div>
{{#OVERDUE}}<p class="late">{{TEXT}}</p>{{#WAS}}<p class="word">{{LATE_WORD}}</p>{{/WAS}}{{/OVERDUE}}{{#LATER}}<template data-from="{{UNTIL}}"><p class="late">{{TEXT}}</p>{{#WAS}}<p class="word">{{LATE_WORD}}</p>{{/WAS}}</template>{{/LATER}}
{{#DRIVE}}<p class="drive{{#ENDS}} until{{/ENDS}}" dir="auto">{{TEXT:x-typed}}</p>{{/DRIVE}}
<p class="word then">{{WORD}}</p>
<p class="why" dir="auto">{{WHY:x-typed}}</p>
{{#DO}}<p class="do" dir="auto"><strong class="now">After that:</strong><strong>What to do:</strong> {{WHAT_TO_DO:x-typed}}</p>{{/DO}}
{{#MORE}}<details class="more"><summary>{{COUNT}}</summary><ul>{{#REASON}}<li dir="auto">{{WHY:x-typed}}{{#ITS_ACTION}} <strong>What to do:</strong> {{TEXT:x-typed}}{{/ITS_ACTION}}</li>{{/REASON}}</ul></details>{{/MORE}}
{{#KEEP}}<p class="keep">{{TEXT}}</p>{{/KEEP}}
</div>
</section>
